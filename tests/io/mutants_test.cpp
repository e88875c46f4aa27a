// Every parser on its corpus and 20 000 mutants of it: a sound body or InvalidInput, in little
// memory and time. The libFuzzer targets of tests/fuzz go further.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>

#include "io/measured_units.h"
#include "io/read.h"
#include "tests/fuzz/measured.h"
#include "tests/fuzz/pieces.h"
#include "tests/fuzz/sound.h"
#include "tests/io/samples.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CHLADNI_COUNTS_MEMORY 0  // the sanitizer has an allocator of its own
#else
#define CHLADNI_COUNTS_MEMORY 1
#endif

namespace {

std::ptrdiff_t bytes_live = 0, bytes_peak = 0;

}  // namespace

#if CHLADNI_COUNTS_MEMORY
// glibc lets a program replace its allocator and still call the one underneath; Eigen allocates by
// malloc, the standard library by operator new, which calls malloc.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void __libc_free(void*);

static void* counted(void* memory) {
  bytes_live += static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  bytes_peak = std::max(bytes_peak, bytes_live);
  return memory;
}
void* malloc(std::size_t size) { return counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* memory, std::size_t size) {
  bytes_live -= static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  return counted(__libc_realloc(memory, size));
}
void free(void* memory) {
  bytes_live -= static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  __libc_free(memory);
}
}
#endif

namespace chladni::io {
namespace {

constexpr int kMutants = 20'000;
constexpr std::ptrdiff_t kMemoryPerByte = 64, kMemoryAtLeast = 1 << 16;
// Small matrices, one per line of frequency, which may have two bytes.
constexpr std::ptrdiff_t kMeasuredMemoryPerByte = 256;
constexpr std::ptrdiff_t kMemoryForPieces = std::ptrdiff_t{3} << 20U;  // a block, and its growth
constexpr std::chrono::seconds kLongest{5};

// Numbers and words that parsers trip over, as text and as bytes.
const std::array<std::string, 30> kWords{"0",
                                         "-1",
                                         "1",
                                         "2147483647",
                                         "2147483648",
                                         "4294967295",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "18446744073709551616",
                                         "1e308",
                                         "1e999",
                                         "1e-400",
                                         "nan",
                                         "-inf",
                                         "1,5",
                                         "0x10",
                                         "$EndNodes",
                                         "$Elements\n",
                                         "endsolid",
                                         "facet",
                                         "*ELEMENT, TYPE=C3D10\n",
                                         "*NODE\n",
                                         "GENERATE",
                                         "# ",
                                         "\n",
                                         "\r",
                                         "element vertex 4000000000\n",
                                         std::string(4, '\0'),
                                         std::string(4, '\xff'),
                                         std::string("\0\0\0\0\0\0\xf8\x7f", 8)};

std::string mutant(const std::vector<std::string>& seeds, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return random() % std::max<std::size_t>(n, 1); };
  std::string bytes = seeds[below(seeds.size())];
  for (std::size_t change = 1 + below(4); change > 0; --change) {
    const std::size_t at = below(bytes.size()), length = below(32);
    switch (below(7)) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      case 3:
        bytes.insert(at, kWords.at(below(kWords.size())));
        break;
      case 4:
        bytes.replace(at, length, kWords.at(below(kWords.size())));
        break;
      case 5: {  // a whole number becomes another
        const std::size_t digit = std::min(bytes.find_first_of("0123456789", at), bytes.size());
        const std::size_t end =
            std::min(bytes.find_first_not_of("0123456789", digit), bytes.size());
        bytes.replace(digit, end - digit, kWords.at(below(12)));
        break;
      }
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

struct Parser {
  const char* name;
  std::function<bool(std::string_view)> gives_sound_result;
  std::ptrdiff_t memory_per_byte = kMemoryPerByte;
  const char* corpus = name;
  std::ptrdiff_t memory_at_least = kMemoryAtLeast;
};

void PrintTo(const Parser& parser, std::ostream* out) { *out << parser.name; }

const std::array<Parser, 12> kParsers{{
    {"stl", [](std::string_view bytes) { return is_sound(parse_stl(bytes)); }},
    {"off", [](std::string_view bytes) { return is_sound(parse_off(bytes)); }},
    {"ply", [](std::string_view bytes) { return is_sound(parse_ply(bytes)); }},
    {"obj", [](std::string_view bytes) { return is_sound(parse_obj(bytes)); }},
    {"msh", [](std::string_view bytes) { return is_sound(parse_msh(bytes)); }},
    {"inp", [](std::string_view bytes) { return is_sound(parse_inp(bytes)); }},
    {"frf_csv", [](std::string_view bytes) { return is_sound(read_frf_csv(bytes)); },
     kMeasuredMemoryPerByte},
    {"frf_uff", [](std::string_view bytes) { return is_sound(read_frf_uff(bytes)); },
     kMeasuredMemoryPerByte},
    {"time_csv", [](std::string_view bytes) { return is_sound(read_time_csv(bytes)); },
     kMeasuredMemoryPerByte},
    {"time_pieces", [](std::string_view bytes) { return is_sound(read_time_pieces(bytes)); },
     2 * kMeasuredMemoryPerByte, "time_csv", kMemoryForPieces},
    {"time_uff", [](std::string_view bytes) { return is_sound(read_time_uff(bytes)); },
     kMeasuredMemoryPerByte},
    {"shapes_uff", [](std::string_view bytes) { return is_sound(read_shapes_uff(bytes)); },
     kMeasuredMemoryPerByte},
}};

class Mutants : public testing::TestWithParam<Parser> {
 protected:
  static std::vector<std::string> seeds() {
    std::vector<std::string> names, bytes;
    const std::string folder = std::string("tests/fuzz/corpus/") + GetParam().corpus;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::string(CHLADNI_SOURCE_DIR) + "/" + folder)) {
      names.push_back(GetParam().corpus + ("/" + entry.path().filename().string()));
    }
    std::sort(names.begin(), names.end());
    for (const std::string& name : names) bytes.push_back(sample(name));
    return bytes;
  }
};

TEST_P(Mutants, CorpusIsRead) {
  const auto all = seeds();
  ASSERT_FALSE(all.empty());
  for (const std::string& bytes : all) EXPECT_TRUE(GetParam().gives_sound_result(bytes));
}

TEST_P(Mutants, AreReadOrRefused) {
  const auto all = seeds();
  (void)factor_of("mm", "m");  // the table of units is read once, and stays
  std::mt19937 random(20'260'101);
  int read = 0, refused = 0;
  for (int i = 0; i < kMutants; ++i) {
    const std::string bytes = mutant(all, random);
    const auto start = std::chrono::steady_clock::now();
    const std::ptrdiff_t before = bytes_live;
    bytes_peak = before;
    try {
      ASSERT_TRUE(GetParam().gives_sound_result(bytes)) << "mutant " << i;
      ++read;
    } catch (const InvalidInput& error) {
      ASSERT_FALSE(std::string(error.what()).empty()) << "mutant " << i;
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << "mutant " << i << ": " << error.what();
    }
    ASSERT_LE(bytes_peak - before,
              GetParam().memory_at_least +
                  GetParam().memory_per_byte * static_cast<std::ptrdiff_t>(bytes.size()))
        << "mutant " << i << " of " << bytes.size() << " bytes";
    ASSERT_LT(std::chrono::steady_clock::now() - start, kLongest) << "mutant " << i;
  }
  EXPECT_GT(read, kMutants / 100);  // the mutants are not all broken at the first byte
  EXPECT_GT(refused, kMutants / 4);
}

// Files that are many times larger in memory than on the disk, to be read in little.
struct Large {
  const char* name;
  std::string bytes;
  std::function<bool(std::string_view, std::size_t limit)> is_read;
};

template <typename Options>
Options limited_to(std::size_t limit) {
  Options options;
  options.limit_bytes = limit;
  return options;
}

bool reads_frf_csv(std::string_view bytes, std::size_t limit) {
  return is_sound(parse_frf_csv(bytes, "f.csv", limited_to<FrfOptions>(limit)));
}

bool reads_time_csv(std::string_view bytes, std::size_t limit) {
  auto options = limited_to<TimeOptions>(limit);
  options.sample_time_s = 0.1;
  return is_sound(parse_time_csv(bytes, "f.csv", options));
}

std::string repeated(const std::string& head, const std::string& line, int count) {
  std::string text = head;
  for (int k = 0; k < count; ++k) text += line;
  return text;
}

// Dataset 58 of real numbers over time, or complex ones over frequency, in text.
std::string zeros_58(bool is_recording, int count) {
  std::string text = "    -1\n    58\nNONE\nNONE\nNONE\nNONE\nNONE\n";
  text += std::string("    ") + (is_recording ? "1" : "4") +
          "         0    0         0       NONE         1   3       NONE         1   3\n";
  text += (is_recording ? "         2" : "         5") + std::string("    ") +
          std::to_string(count) + "         1  0.00000E+00  1.00000E+00  0.00000E+00\n";
  for (const char* axis : {"18", "12", "13", "0"}) {
    text += std::string("        ") + axis +
            "    0    0    0                 NONE                 "
            "NONE\n";
  }
  for (int k = 0; k < (is_recording ? count : 2 * count); ++k) text += k % 40 == 39 ? "0\n" : "0 ";
  return text + "\n    -1\n";
}

std::vector<Large> large_files() {
  std::string ascending = "freq_hz,re_y1u1,im_y1u1\n";
  for (int k = 0; k < 200'000; ++k) ascending += std::to_string(k) + ",0,0\n";
  std::string alternating = "experiment,y\n";
  for (int k = 0; k < 50'000; ++k) alternating += k % 2 == 0 ? "0,1\n" : "1,1\n";
  return {
      {"responses", ascending, reads_frf_csv},
      {"a recording", repeated("y,u\n", "0,0\n", 400'000), reads_time_csv},
      {"empty columns", repeated("freq_hz,a,b,c,d,e,f,g\n", ",,,,,,,\n", 100'000), reads_frf_csv},
      {"a recording per line", alternating, reads_time_csv},
      {"dataset 58", zeros_58(false, 300'000),
       [](std::string_view bytes, std::size_t limit) {
         return is_sound(parse_frf_uff(bytes, "f.uff", limited_to<FrfOptions>(limit)));
       }},
      {"dataset 58 over time", zeros_58(true, 300'000),
       [](std::string_view bytes, std::size_t limit) {
         return is_sound(parse_time_uff(bytes, "f.uff", limited_to<TimeOptions>(limit)));
       }}};
}

// The limit is half of what there is: reading takes no more than all, or refuses before it does.
TEST(Limits, NoFileTakesMoreThanTwiceItsLimit) {
  for (const auto& file : large_files()) {
    SCOPED_TRACE(file.name);
    int refused = 0;
    for (std::size_t limit = 1U << 14U; limit <= 1U << 28U; limit *= 2) {
      const std::ptrdiff_t before = bytes_live;
      bytes_peak = before;
      try {
        EXPECT_TRUE(file.is_read(file.bytes, limit));
      } catch (const InvalidInput& error) {
        ++refused;
        const bool for_memory = std::string(error.what()).find("MB") != std::string::npos;
        EXPECT_TRUE(for_memory || file.name == std::string("empty columns")) << error.what();
      }
      EXPECT_LE(bytes_peak - before, kMemoryAtLeast + 2 * static_cast<std::ptrdiff_t>(limit))
          << "limit " << limit << ", file " << file.bytes.size();
    }
    EXPECT_GT(refused, 3);
    if (file.name != std::string("empty columns")) {
      EXPECT_LT(refused, 13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Parsers, Mutants, testing::ValuesIn(kParsers),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace chladni::io
