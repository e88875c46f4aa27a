// Version 7.3 of .mat files against HDF5 itself, as MATLAB describes what it writes: a second
// implementation, which shares nothing with libmatio.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "io/frf_file.h"
#include "io/mat.h"
#include "io/recordings_file.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
using Sizes = std::vector<hsize_t>;  // HDF5's order: the reverse of MATLAB's

constexpr hsize_t kHead = 512;  // before HDF5's own bytes

class MatHdf5 : public testing::Test {
 protected:
  static void SetUpTestSuite() { setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1); }
};

/// Two parts of a complex number, as MATLAB names them.
hid_t complex_type() {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Complex));
  H5Tinsert(type, "real", 0, H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "imag", sizeof(double), H5T_NATIVE_DOUBLE);
  return type;
}

void set_class(hid_t dataset, const std::string& name) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, name.size());
  const hid_t scalar = H5Screate(H5S_SCALAR);
  const hid_t attribute =
      H5Acreate2(dataset, "MATLAB_class", type, scalar, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Awrite(attribute, type, name.data()), 0);
  H5Aclose(attribute);
  H5Sclose(scalar);
  H5Tclose(type);
}

std::string class_of(hid_t dataset) {
  const hid_t attribute = H5Aopen(dataset, "MATLAB_class", H5P_DEFAULT);
  if (attribute < 0) return "";
  const hid_t type = H5Aget_type(attribute);
  std::string name(H5Tget_size(type), ' ');
  EXPECT_GE(H5Aread(attribute, type, name.data()), 0);
  H5Tclose(type);
  H5Aclose(attribute);
  return name;
}

hid_t written(hid_t where, const std::string& name, hid_t type, const Sizes& sizes,
              const void* data, const std::string& matlab_class) {
  const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
  const hid_t dataset =
      H5Dcreate2(where, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), 0);
  set_class(dataset, matlab_class);
  H5Sclose(space);
  return dataset;
}

// A cell row of texts: references to char arrays in the group "#refs#".
void write_texts(hid_t file, const std::string& name, const std::vector<std::string>& texts) {
  const hid_t group = H5Gcreate2(file, "#refs#", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  std::vector<hobj_ref_t> references(texts.size());
  for (std::size_t k = 0; k < texts.size(); ++k) {
    const std::vector<std::uint16_t> letters(texts[k].begin(), texts[k].end());
    const std::string own = "t" + std::to_string(k);
    H5Dclose(written(group, own, H5T_NATIVE_UINT16, {letters.size(), 1}, letters.data(), "char"));
    H5Rcreate(&references[k], group, own.c_str(), H5R_OBJECT, -1);
  }
  H5Dclose(written(file, name, H5T_STD_REF_OBJ, {texts.size(), 1}, references.data(), "cell"));
  H5Gclose(group);
}

void write_head(const std::filesystem::path& file) {
  std::string head =
      "MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Nov 26 10:00:00 2026 "
      "HDF5 schema 1.00 .";
  head.resize(116, ' ');
  head += std::string(8, '\0') + std::string("\x00\x02IM", 4);
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.write(head.data(), static_cast<std::streamsize>(head.size()));
}

TEST_F(MatHdf5, WhatMatlabWritesIsRead) {
  const TemporaryFile file("matlab.mat");
  const hid_t properties = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_userblock(properties, kHead);
  const hid_t hdf5 = H5Fcreate(file.path.c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT);
  ASSERT_GE(hdf5, 0);
  const std::vector<double> frequency{10.0, 20.0, 30.0};
  std::vector<Complex> response;  // 3 lines x 2 outputs x 1 input, the first dimension fastest
  for (int k = 0; k < 6; ++k) response.emplace_back(1.0 + k, -0.5 * k);
  const hid_t type = complex_type();
  H5Dclose(written(hdf5, "freq_hz", H5T_NATIVE_DOUBLE, {1, 3}, frequency.data(), "double"));
  H5Dclose(written(hdf5, "H", type, {2, 3}, response.data(), "double"));
  write_texts(hdf5, "output_names", {"left", "right"});
  H5Tclose(type);
  H5Fclose(hdf5);
  H5Pclose(properties);
  write_head(file.path);
  const auto found = read_frf(file.path);
  EXPECT_EQ(found.format, "MAT 7.3");
  EXPECT_EQ(found.set.frequency_hz, Eigen::Vector3d(10.0, 20.0, 30.0));
  ASSERT_EQ(found.set.output_count(), 2);
  EXPECT_EQ(found.set.outputs[1].name, "right");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(found.set.value[k](0, 0), response[k]);
    EXPECT_EQ(found.set.value[k](1, 0), response[3 + k]);
  }
}

std::vector<hsize_t> sizes_of(hid_t dataset) {
  const hid_t space = H5Dget_space(dataset);
  Sizes sizes(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  H5Sclose(space);
  return sizes;
}

TEST_F(MatHdf5, WhatIsWrittenIsHdf5AsMatlabReadsIt) {
  const TemporaryFile file("chladni.mat");
  const Eigen::MatrixXd real = Eigen::RowVectorXd::LinSpaced(6, 0.1, 7.0).reshaped(2, 3);
  const Eigen::MatrixXcd both = Complex(0.5, -3.0) * real;
  write_mat(file.path,
            {{"real", real}, {"both", both}, {"names", std::vector<std::string>{"left", "right"}}},
            MatVersion::mat_7_3);
  const hid_t hdf5 = H5Fopen(file.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(hdf5, 0);
  const hid_t first = H5Dopen2(hdf5, "real", H5P_DEFAULT);
  EXPECT_EQ(class_of(first), "double");
  EXPECT_EQ(sizes_of(first), (Sizes{3, 2}));
  Eigen::MatrixXd numbers(2, 3);
  H5Dread(first, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
  EXPECT_EQ(numbers, real);
  const hid_t second = H5Dopen2(hdf5, "both", H5P_DEFAULT);
  const hid_t type = complex_type();
  Eigen::MatrixXcd values(2, 3);
  ASSERT_GE(H5Dread(second, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  EXPECT_EQ(class_of(second), "double");
  EXPECT_EQ(values, both);
  const hid_t third = H5Dopen2(hdf5, "names", H5P_DEFAULT);
  EXPECT_EQ(class_of(third), "cell");
  std::array<hobj_ref_t, 2> references{};
  H5Dread(third, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data());
  const hid_t text = H5Rdereference2(third, H5P_DEFAULT, H5R_OBJECT, &references[1]);
  EXPECT_EQ(class_of(text), "char");
  EXPECT_EQ(sizes_of(text), (Sizes{5, 1}));
  std::array<std::uint16_t, 5> letters{};
  H5Dread(text, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, letters.data());
  EXPECT_EQ(std::string(letters.begin(), letters.end()), "right");
  H5Tclose(type);
  for (const hid_t dataset : {first, second, third, text}) H5Dclose(dataset);
  H5Fclose(hdf5);
}

// A dataset whose chunks were never written is zeros of any number, and all went to the disk.
TEST_F(MatHdf5, RecordingsThatAreNotInTheFileAreRefused) {
  const TemporaryFile file("hollow.mat");
  {
    const hid_t list = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(list, kHead);
    const hid_t out = H5Fcreate(file.path.c_str(), H5F_ACC_TRUNC, list, H5P_DEFAULT);
    const Sizes sizes{2000, 20000}, chunk{100, 1000};
    const hid_t space = H5Screate_simple(2, sizes.data(), nullptr);
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(how, 2, chunk.data());
    const hid_t y = H5Dcreate2(out, "y", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, how, H5P_DEFAULT);
    set_class(y, "double");
    const double step = 0.5;
    H5Dclose(written(out, "Ts", H5T_NATIVE_DOUBLE, {1, 1}, &step, "double"));
    H5Dclose(y);
    H5Pclose(how);
    H5Sclose(space);
    H5Fclose(out);
    H5Pclose(list);
  }
  write_head(file.path);
  const auto said =
      refusal_of([&] { return read_in_pieces(file.path, {.limit_bytes = std::size_t{1} << 24U}); });
  EXPECT_NE(said.find("says that it holds 3.2e+08 bytes of samples"), said.npos) << said;
}

}  // namespace
}  // namespace chladni::io
