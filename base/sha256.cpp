#include "base/sha256.h"

#include <unistd.h>

#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "base/error.h"

namespace chladni {
namespace {

using State = std::array<std::uint32_t, 8>;

constexpr State kStart = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                          0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
constexpr std::size_t kPiece = std::size_t{1} << 20U;  // whole blocks

// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kRound = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

constexpr std::size_t kBlock = 64;

// Padding of a message of `length` bytes: its last bytes, a one, zeros, the length in bits.
std::string padded(std::string_view left_over, std::uint64_t length) {
  std::string all(left_over);
  all.push_back('\x80');
  while (all.size() % kBlock != 56) all.push_back('\0');
  const std::uint64_t bits = 8 * length;
  for (int shift = 56; shift >= 0; shift -= 8) {
    all.push_back(static_cast<char>((bits >> static_cast<unsigned>(shift)) & 0xffU));
  }
  return all;
}

std::array<std::uint32_t, 64> schedule(std::string_view block) {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 64; ++i) {
    w[i / 4 % 16] = (w[i / 4 % 16] << 8U) | static_cast<unsigned char>(block[i]);
  }
  for (std::size_t i = 16; i < 64; ++i) {
    const auto a = w[i - 15];
    const auto b = w[i - 2];
    w[i] = w[i - 16] + w[i - 7] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3U)) +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10U));
  }
  return w;
}

void mix(State& state, std::string_view block) {
  const auto w = schedule(block);
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t i = 0; i < 64; ++i) {
    const auto s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const auto t1 = h + s1 + ((e & f) ^ (~e & g)) + kRound[i] + w[i];
    const auto s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const auto t2 = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const State mixed = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state[i] += mixed[i];
}

// Mixes whole blocks. Returns the remaining bytes.
std::string_view mixed_blocks(State& state, std::string_view bytes) {
  for (; bytes.size() >= kBlock; bytes.remove_prefix(kBlock)) mix(state, bytes.substr(0, kBlock));
  return bytes;
}

std::string digits_of(State state, std::string_view left_over, std::uint64_t length) {
  mixed_blocks(state, padded(left_over, length));
  std::string digits;
  for (const auto word : state) {
    for (int shift = 28; shift >= 0; shift -= 4) {
      digits.push_back("0123456789abcdef"[(word >> static_cast<unsigned>(shift)) & 0xfU]);
    }
  }
  return digits;
}

}  // namespace

std::string sha256(std::string_view bytes) {
  State state = kStart;
  const std::string_view left_over = mixed_blocks(state, bytes);
  return digits_of(state, left_over, bytes.size());
}

std::string sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  State state = kStart;
  std::uint64_t length = 0;
  std::string piece(kPiece, '\0');
  std::string_view left_over;
  while (stream.read(piece.data(), static_cast<std::streamsize>(kPiece)) || stream.gcount() > 0) {
    const auto count = static_cast<std::size_t>(stream.gcount());
    length += count;
    left_over = mixed_blocks(state, std::string_view(piece).substr(0, count));
  }
  if (!stream.eof()) {
    std::error_code ignored;
    const bool may =
        std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), R_OK) == 0;
    if (may) throw OutOfResources(file.string() + ": cannot be read, though it is there");
    throw InvalidInput(file.string() + ": cannot be read; expected a file that can");
  }
  return digits_of(state, left_over, length);
}

}  // namespace chladni
