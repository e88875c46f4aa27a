#include "host/loaded_code.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <new>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/sha256.h"

namespace chladni {
namespace {

constexpr std::array<std::string_view, 15> kComputing = {
    "libopenblas", "libblas", "liblapack", "libcholmod", "libsuitesparse",
    "libamd",      "libcamd", "libcolamd", "libccolamd", "libmetis",
    "libgmp",      "libmpfr", "libm.so",   "libc.so",    "libstdc++"};

constexpr int kNoMemory = 2;  // what note_object tells beside 0 and 1

struct Object {
  std::string name, build;
};

// The build ID in a segment of notes; empty where there is none.
std::string build_id(const char* note, std::size_t size) {
  const auto padded = [](std::size_t count) { return (count + 3) / 4 * 4; };
  for (const char* const end = note + size; note + sizeof(ElfW(Nhdr)) <= end;) {
    ElfW(Nhdr) head;
    std::memcpy(&head, note, sizeof head);
    const char* const name = note + sizeof head;
    const char* const id = name + padded(head.n_namesz);
    if (id + head.n_descsz > end) return "";
    if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
      return {id, head.n_descsz};
    }
    note = id + padded(head.n_descsz);
  }
  return "";
}

bool holds_this_code(const dl_phdr_info& object) {
  const auto here = reinterpret_cast<std::uintptr_t>(&loaded_code);
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const auto& part = object.dlpi_phdr[i];
    const auto begin = static_cast<std::uintptr_t>(object.dlpi_addr + part.p_vaddr);
    if (part.p_type == PT_LOAD && here >= begin && here - begin < part.p_memsz) return true;
  }
  return false;
}

std::string build_of(const dl_phdr_info& object, const std::string& file) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const auto& part = object.dlpi_phdr[i];
    if (part.p_type != PT_NOTE) continue;
    const auto address = static_cast<std::uintptr_t>(object.dlpi_addr + part.p_vaddr);
    const auto id = build_id(reinterpret_cast<const char*>(address), part.p_memsz);
    if (!id.empty()) return id;
  }
  return sha256_of_file(file);
}

// Called for each loaded object, from C: nothing may be thrown.
int note_object(dl_phdr_info* object, std::size_t /*size*/, void* list) {
  try {
    const std::string file = *object->dlpi_name == '\0' ? "/proc/self/exe" : object->dlpi_name;
    const auto name = std::filesystem::path(file).filename().string();
    const bool ours = holds_this_code(*object);
    const bool computing = std::ranges::any_of(
        kComputing, [&](std::string_view begin) { return name.starts_with(begin); });
    if (!ours && !computing) return 0;
    static_cast<std::vector<Object>*>(list)->push_back(
        {ours ? "chladni" : name, build_of(*object, file)});
    return 0;
  } catch (const std::bad_alloc&) {  // not through the linker's frames
    return kNoMemory;
  } catch (...) {
    return 1;
  }
}

std::string vector_instructions() {
#if defined(__x86_64__) && defined(__GNUC__)
  std::string all;
  if (__builtin_cpu_supports("avx") != 0) all += " avx";
  if (__builtin_cpu_supports("avx2") != 0) all += " avx2";
  if (__builtin_cpu_supports("fma") != 0) all += " fma";
  if (__builtin_cpu_supports("avx512f") != 0) all += " avx512f";
  if (__builtin_cpu_supports("avx512vl") != 0) all += " avx512vl";
  return all;
#else
  return "";
#endif
}

std::string looked_up() {
  std::vector<Object> objects;
  const int fault = dl_iterate_phdr(note_object, &objects);
  if (fault == kNoMemory) throw std::bad_alloc();
  if (fault != 0) {
    throw InvalidInput("the loaded libraries cannot be told apart");
  }
  std::ranges::sort(objects, {}, &Object::name);
  std::string all;
  for (const auto& object : objects) all += object.name + "=" + sha256(object.build) + " ";
  return all + vector_instructions();
}

}  // namespace

const std::string& loaded_code() {
  static const std::string code = looked_up();
  return code;
}

}  // namespace chladni
