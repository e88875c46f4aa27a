#include "io/time_file.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <utility>

#include "base/draw.h"
#include "base/error.h"
#include "io/uff/time_uff.h"
#include "tests/io/measured/frf_samples.h"
#include "tests/io/measured/written_uff.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

recordings::TimeData random_recordings() {
  Draw draw(9);
  recordings::TimeData data;
  data.outputs.resize(2);
  data.inputs.resize(1);
  data.references.resize(1);
  data.outputs[0].name = "y1";
  data.outputs[1].name = "force plate, left";  // a name that looks like an input's
  data.inputs[0].name = "z3";                  // and one that looks like an output's
  data.references[0].name = "r1";
  data.sample_time_s = 1.0 / 4096.0;
  data.period = 4;
  const auto random = [&](Eigen::Index columns) {
    Eigen::MatrixXd samples(12, columns);
    for (auto& sample : samples.reshaped()) sample = draw.normal();
    return samples;
  };
  for (int n = 0; n < 4; ++n) {
    recordings::Record record;
    record.outputs = random(2);
    record.inputs = random(1);
    record.references = random(1);
    record.experiment = n / 2;
    record.realisation = n % 2;
    data.records.push_back(record);
  }
  return data;
}

void expect_same(const recordings::TimeData& found, const recordings::TimeData& expected) {
  ASSERT_EQ(found.outputs.size(), expected.outputs.size());
  ASSERT_EQ(found.inputs.size(), expected.inputs.size());
  ASSERT_EQ(found.references.size(), expected.references.size());
  EXPECT_EQ(found.outputs[1].name, expected.outputs[1].name);
  EXPECT_EQ(found.inputs[0].name, expected.inputs[0].name);
  EXPECT_EQ(found.references[0].name, expected.references[0].name);
  EXPECT_EQ(found.sample_time_s, expected.sample_time_s);
  EXPECT_EQ(found.period, expected.period);
  ASSERT_EQ(found.records.size(), expected.records.size());
  for (std::size_t r = 0; r < expected.records.size(); ++r) {
    EXPECT_EQ(found.records[r].outputs, expected.records[r].outputs);
    EXPECT_EQ(found.records[r].inputs, expected.records[r].inputs);
    EXPECT_EQ(found.records[r].references, expected.records[r].references);
    EXPECT_EQ(found.records[r].experiment, expected.records[r].experiment);
    EXPECT_EQ(found.records[r].realisation, expected.records[r].realisation);
  }
}

TEST(TimeFile, CsvReadsBackWhatItWroteToTheLastBit) {
  const auto data = random_recordings();
  expect_same(parse_time_csv(time_csv(data), "t.csv").data, data);
}

TEST(TimeFile, UffReadsBackWhatItWroteToTheLastBit) {
  auto data = random_recordings();
  data.outputs[0].unit = "m/s";
  data.outputs[0].kind = modal::FrfKind::mobility;
  data.inputs[0].unit = "N";
  const auto found = parse_time_uff(written_uff(data, UffEncoding::binary), "t.uff").data;
  expect_same(found, data);
  EXPECT_EQ(found.outputs[0].unit, "m/s");
  EXPECT_EQ(found.outputs[0].kind, modal::FrfKind::mobility);
  EXPECT_EQ(found.inputs[0].unit, "N");
}

// Channels with nodes, directions and places; the place of y1 stands at no node of its own.
recordings::TimeData placed_recordings() {
  auto data = random_recordings();
  data.outputs[0].direction = Eigen::Vector3d::UnitZ();
  data.outputs[0].position = Eigen::Vector3d(0.1, 0.2, 0.3);
  data.outputs[1].node = 7;
  data.outputs[1].direction = Eigen::Vector3d(0.6, 0.0, 0.8);
  data.outputs[1].position = Eigen::Vector3d(1.0, 2.0, 3.0);
  data.inputs[0].direction = -Eigen::Vector3d::UnitY();
  data.inputs[0].position = Eigen::Vector3d(4.0, 5.0, 6.0);
  data.references[0].node = 9;
  return data;
}

struct Transfer {
  std::vector<std::string> lost;
  recordings::TimeData back;
};

Transfer transferred(const recordings::TimeData& data, const std::string& name) {
  const TemporaryFile file(name);
  auto lost = write_time(file.path, data);
  return {std::move(lost), read_time(file.path).data};
}

TEST(TimeFile, MatKeepsNodesDirectionsAndPlaces) {
  const auto data = placed_recordings();
  const auto [lost, back] = transferred(data, "placed.mat");
  EXPECT_TRUE(lost.empty()) << testing::PrintToString(lost);
  for (const auto& [found, expected] :
       {std::pair(&back.outputs, &data.outputs), std::pair(&back.inputs, &data.inputs),
        std::pair(&back.references, &data.references)}) {
    ASSERT_EQ(found->size(), expected->size());
    for (std::size_t c = 0; c < found->size(); ++c) {
      EXPECT_EQ((*found)[c].node, (*expected)[c].node);
      EXPECT_EQ((*found)[c].direction, (*expected)[c].direction);
      EXPECT_EQ((*found)[c].position, (*expected)[c].position);
    }
  }
}

// A unit such as V does not tell what is measured.
TEST(TimeFile, MatKeepsTheQuantityThatNoUnitTells) {
  auto data = random_recordings();
  data.outputs[0].unit = "V";
  data.outputs[0].kind = modal::FrfKind::accelerance;
  for (const auto kind : {modal::FrfKind::receptance, modal::FrfKind::mobility}) {
    data.outputs[1].kind = kind;
    const auto back = transferred(data, "kinds.mat").back;
    EXPECT_EQ(back.outputs[0].kind, modal::FrfKind::accelerance);
    EXPECT_EQ(back.outputs[0].unit, "V");
    EXPECT_EQ(back.outputs[1].kind, kind);
  }
  const TemporaryFile file("kinds.mat");
  (void)write_time(file.path, data);
  TimeOptions options;
  options.unit = "m";  // the second output is a velocity without a unit
  EXPECT_THROW((void)read_time(file.path, options), InvalidInput);
}

TEST(TimeFile, UffKeepsPlacesAndNamesObliqueDirections) {
  const auto data = placed_recordings();
  const auto [lost, back] = transferred(data, "placed.uff");
  ASSERT_EQ(lost.size(), 1U) << testing::PrintToString(lost);
  EXPECT_EQ(lost[0],
            "UFF holds directions along the axes only: that of force plate, left is left out");
  ASSERT_EQ(back.outputs.size(), 2U);
  EXPECT_EQ(back.outputs[1].node, 7);
  EXPECT_EQ(back.references.at(0).node, 9);
  EXPECT_EQ(back.inputs.at(0).direction, data.inputs[0].direction);
  for (const auto& [found, expected] : {std::pair(&back.outputs[0], &data.outputs[0]),
                                        std::pair(&back.outputs[1], &data.outputs[1]),
                                        std::pair(&back.inputs[0], &data.inputs[0])}) {
    ASSERT_TRUE(found->position) << found->name;
    EXPECT_LT((*found->position - *expected->position).norm(), 1e-15) << found->name;
  }
}

TEST(TimeFile, UffNamesTheSecondPlaceOfANode) {
  auto data = placed_recordings();
  data.references[0].node = 7;
  data.references[0].position = Eigen::Vector3d(1.0, 2.0, 4.0);
  const auto lost = transferred(data, "two_places.uff").lost;
  ASSERT_EQ(lost.size(), 2U) << testing::PrintToString(lost);
  EXPECT_EQ(lost[1], "UFF holds one place of a node: that of r1, at node 7, is left out");
}

TEST(TimeFile, CsvNamesAllThatItLeavesOut) {
  auto data = placed_recordings();
  EXPECT_EQ(
      transferred(data, "placed.csv").lost,
      (std::vector<std::string>{"CSV holds no nodes, directions and places: they are left out"}));
  data.outputs[1].unit = "m/s";
  EXPECT_EQ(transferred(data, "placed.csv").lost.at(0),
            "CSV holds no units: say unit = \"m/s\" on reading");
  EXPECT_TRUE(transferred(random_recordings(), "bare.csv").lost.empty());
}

// A record ends in a table where its numbers do.
TEST(TimeFile, CsvTellsBlowsApartThatHaveTheSameNumbers) {
  auto data = random_recordings();
  for (auto& record : data.records) record.experiment = record.realisation = 0;
  EXPECT_NE(refusal_of([&] {
              return time_csv(data);
            }).find("two neighbouring recordings of experiment 0 and realisation 0"),
            std::string::npos);
  data.period = 0;
  const auto found = parse_time_csv(time_csv(data), "t.csv").data;
  ASSERT_EQ(found.records.size(), 4U);
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_EQ(found.records[r].outputs, data.records[r].outputs);
    EXPECT_EQ(found.records[r].experiment, 0);
    EXPECT_EQ(found.records[r].realisation, static_cast<int>(r));
  }
}

// The version is the realisation, as long as no channel has two functions of one version.
TEST(TimeFile, UffRealisationsAreAllDifferent) {
  auto data = random_recordings();
  const auto read_back = [&](const std::array<int, 4>& versions) {
    for (std::size_t r = 0; r < 4; ++r) {
      data.records[r].experiment = 0;
      data.records[r].realisation = versions[r];
    }
    std::vector<int> found;
    const auto back = parse_time_uff(written_uff(data, UffEncoding::binary), "t.uff").data;
    for (std::size_t r = 0; r < back.records.size(); ++r) {
      EXPECT_EQ(back.records[r].outputs, data.records[r].outputs);
      found.push_back(back.records[r].realisation);
    }
    return found;
  };
  EXPECT_EQ(read_back({1, 3, 4, 7}), (std::vector<int>{1, 3, 4, 7}));
  EXPECT_EQ(read_back({1, 1, 2, 7}), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(read_back({5, 5, 5, 6}), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(read_back({-1, 0, 2, 3}), (std::vector<int>{0, 1, 2, 3}));
}

TEST(TimeFile, NamesTellTheSide) {
  const auto file =
      parse_time_csv("time_s,u1,y1,force,acceleration,r2\n0,1,2,3,4,5\n1,1,2,3,4,5\n", "t.csv");
  ASSERT_EQ(file.data.inputs.size(), 2U);
  EXPECT_EQ(file.data.inputs[1].name, "force");
  ASSERT_EQ(file.data.outputs.size(), 2U);
  EXPECT_EQ(file.data.outputs[1].name, "acceleration");
  ASSERT_EQ(file.data.references.size(), 1U);
  EXPECT_EQ(file.notes[0], "outputs: y1, acceleration; inputs: u1, force; references: r2");
  TimeOptions options;
  options.sensor_names = {"force"};
  options.reference_names = {"u1"};
  options.actuator_names = {"y1"};
  const auto other = parse_time_csv("time_s,u1,y1,force\n0,1,2,3\n1,4,5,6\n", "t.csv", options);
  EXPECT_EQ(other.data.outputs[0].name, "force");
  EXPECT_EQ(other.data.records[0].inputs(1, 0), 5.0);
  EXPECT_EQ(other.data.records[0].references(1, 0), 4.0);
}

TEST(TimeFile, UnitAndSampleTimeMayBeStated) {
  TimeOptions options;
  options.sample_time_s = 0.5;
  options.unit = "g";
  options.period = 2;
  const auto file = parse_time_csv("force,acceleration\n1,2\n3,4\n", "t.csv", options);
  EXPECT_EQ(file.data.sample_time_s, 0.5);
  EXPECT_EQ(file.data.period, 2);
  EXPECT_DOUBLE_EQ(file.data.records[0].outputs(1, 0), 4.0 * 9.80665);
  EXPECT_EQ(file.data.outputs[0].kind, modal::FrfKind::accelerance);
}

TEST(TimeFile, AUnitThatIsStatedIsOne) {
  for (const auto* unit : {"UM", "foo", "g/N"}) {
    TimeOptions options;
    options.sample_time_s = 0.5;
    options.unit = unit;
    EXPECT_THROW((void)parse_time_csv("u1,y1\n1,2\n3,4\n", "t.csv", options), InvalidInput) << unit;
  }
}

struct BadRecord {
  const char *bytes, *word;
};

class BadTimeCsv : public testing::TestWithParam<BadRecord> {};

TEST_P(BadTimeCsv, IsRefusedWithItsPlace) {
  try {
    (void)parse_time_csv(GetParam().bytes, "t.csv");
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().word), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find("t.csv"), 0U) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    TimeFile, BadTimeCsv,
    testing::Values(
        BadRecord{"", "no lines"}, BadRecord{"time_s,y1\n", "no line of numbers"},
        BadRecord{"y1,u1\n1,2\n3,4\n", "no sample time"},
        BadRecord{"time_s\n1\n2\n", "no column of a channel"},
        BadRecord{"time_s,y1\n0,1\n", "one sample only"},
        BadRecord{"time_s,y1\n0,1\n0,2\n", "does not ascend"},
        BadRecord{"time_s,y1\n0,1\n1,2\n2.5,3\n3,4\n", "line 4: time_s is 2.5"},
        BadRecord{"time_s,y1\n0,1\n1,\n", "line 3: y1 is empty"},
        BadRecord{"time_s,experiment,y1\n0,0.5,1\n1,0,2\n", "line 2: experiment is 0.5"},
        BadRecord{"time_s,experiment,y1\n0,,1\n1,0,2\n", "line 2: experiment is"},
        BadRecord{"time_s,experiment,y1\n0,20240115,1\n1,0,2\n",
                  "line 2: experiment is 20240115, expected a whole number from 0 to 1000000"},
        BadRecord{"time_s,realisation,y1\n0,-1,1\n1,0,2\n",
                  "realisation is -1, expected a whole number from 0"},
        BadRecord{"time_s,experiment,y1\n0,0,1\n1,0,2\n,1,3\n", "line 4: time_s is empty"},
        BadRecord{"time_s,time,y1\n0,0,1\n1,0,2\n", "two columns"},
        BadRecord{"time_s,y1,out_y1\n0,0,1\n1,0,2\n", "two columns of the channel"},
        BadRecord{"time_s,period,y1\n0,0,1\n1,0,2\n2,1,3\n", "line 4: a period of 1"}));

TEST(TimeFile, UffRefusalsNameBoth) {
  auto data = random_recordings();
  data.records[1].inputs.conservativeResize(11, 1);
  try {
    (void)parse_time_uff(written_uff(data, UffEncoding::text), "t.uff");
    FAIL() << "taken";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("(z3) has 11"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("(y1) has 12"), std::string::npos) << e.what();
  }
}

// Accelerations do not become displacements by a unit.
TEST(TimeFile, UffRefusesAUnitOfAnotherQuantityThanTheFileStates) {
  auto data = random_recordings();
  data.outputs[0].kind = modal::FrfKind::accelerance;
  const auto bytes = written_uff(data, UffEncoding::text);
  EXPECT_EQ(parse_time_uff(bytes, "t.uff").data.outputs[0].kind, modal::FrfKind::accelerance);
  TimeOptions options;
  options.unit = "mm";
  EXPECT_THROW((void)parse_time_uff(bytes, "t.uff", options), InvalidInput);
  options.unit = "g";
  const auto found = parse_time_uff(bytes, "t.uff", options).data;
  EXPECT_EQ(found.outputs[0].unit, "m/s^2");
  EXPECT_NEAR(found.records[0].outputs(0, 0), 9.80665 * data.records[0].outputs(0, 0), 1e-9);
}

TEST(MeasuredData, AHitIsReadAsARecording) {
  const auto tar = std::filesystem::path(CHLADNI_SOURCE_DIR) /
                   "../shared/data/tonewood-1to4/plate_01_raw_time.tar.xz";
  if (!std::filesystem::exists(tar)) GTEST_SKIP() << tar << " is not here";
  const TemporaryFile hit("hit.csv");
  const std::string command = "tar xJOf '" + tar.string() +
                              "' plate_1_____15_11_21_____frf_1.csv > '" + hit.path.string() + "'";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "no tar or xz here";
  TimeOptions options;
  options.sample_time_s = 1.0 / 48000.0;
  const auto file = read_time(hit.path, options);
  EXPECT_EQ(file.data.inputs[0].name, "force");
  EXPECT_EQ(file.data.outputs[0].name, "acceleration");
  EXPECT_EQ(file.data.records[0].outputs(0, 0), -0.003847);
  EXPECT_NEAR(static_cast<double>(file.data.records[0].outputs.rows()) / 48000.0, 2.0, 0.01);
}

// A time column in which samples are missing, or whose step changes, is refused with the place.
TEST(TimeFile, NamesMissingSamplesAndAnotherRate) {
  const auto refusal = [](const std::vector<double>& times) {
    std::string text = "time_s,y1,u1\n";
    for (const double time : times) text += std::to_string(time) + ",1,2\n";
    try {
      (void)parse_time_csv(text, "t.csv");
    } catch (const InvalidInput& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  std::vector<double> sound, missing, faster;
  for (int n = 0; n < 40; ++n) {
    sound.push_back(0.01 * n);
    missing.push_back(0.01 * (n < 20 ? n : n + 3));
    faster.push_back(n < 25 ? 0.01 * n : 0.24 + 0.005 * (n - 24));
  }
  EXPECT_EQ(refusal(sound), "");
  EXPECT_NE(refusal(missing).find("line 22: time_s is 0.23: 3 samples are missing before it"),
            std::string::npos)
      << refusal(missing);
  EXPECT_NE(
      refusal(faster).find("line 27: time_s is 0.245: the sample rate changes from 100 to 200 Hz"),
      std::string::npos)
      << refusal(faster);
  // Blows one after the other without a number of their own, and clocks that stand still.
  std::vector<double> anew, still, back;
  for (int n = 0; n < 40; ++n) {
    anew.push_back(0.01 * (n % 20));
    still.push_back(0.01 * (n < 20 ? n : n - 1));
    back.push_back(0.01 * (n < 20 ? n : n - 4));
  }
  const std::string tell_apart =
      "the time begins anew; give each recording its own experiment or realisation";
  EXPECT_EQ(refusal(anew), "t.csv: line 22: time_s is 0: " + tell_apart);
  EXPECT_EQ(refusal({0.0, 1.0, 2.0, 0.0}), "t.csv: line 5: time_s is 0: " + tell_apart);
  for (const auto& [times, place] :
       {std::pair(still, "line 22: time_s is 0.19"), std::pair(back, "line 22: time_s is 0.16"),
        std::pair(std::vector{0.0, 0.0, 0.0, 1.0, 1.0}, "line 3"),
        std::pair(std::vector{3.0, 2.0, 1.0}, "line 3")}) {
    EXPECT_NE(refusal(times).find(place), std::string::npos) << refusal(times);
    EXPECT_NE(refusal(times).find(": the time does not ascend"), std::string::npos)
        << refusal(times);
  }
}

}  // namespace
}  // namespace chladni::io
