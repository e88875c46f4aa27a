// A library for LD_PRELOAD: one call to the system's libraries fails, or all of them are difficult.
//
// CHLADNI_FAIL_CALL   allocate, write, read, open, sync, close or rename
// CHLADNI_FAIL_AT     which call of this kind fails, counted from 1 where main() begins; 0: none
// CHLADNI_FAIL_ERROR  the error number that it leaves
// CHLADNI_FAIL_ON     if set, all later calls of the kind fail too
// CHLADNI_FAIL_SHORT  if set, each second read and write is interrupted (EINTR), and the others
//                     transfer half of what was asked, or one byte
// CHLADNI_FAIL_COUNT  a file that gets the number of calls of each kind, in the order above
//
// Programs that are started from this one are left alone. Calls within libc itself are not seen:
// of its streams only fwrite and putc are, through which std::cout and std::cerr write.
//
// These always succeed, since nothing that Chladni does after a failure would help:
// - UDUNITS-2: its scanner ends the process without memory (base/quantity.cpp asks for it before)
// - OpenBLAS: its small products use memory that they did not get
// - VTK: its destructors throw without memory
// - matio, which writes to memory (io/matlab/mat.cpp), and HDF5, which it brings
// - malloc from the program itself: Eigen 3.4 frees a matrix twice whose resize gets no memory
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

enum Kind { kAllocate, kWrite, kRead, kOpen, kSync, kClose, kRename, kKinds };
constexpr const char* kNames[kKinds] = {"allocate", "write", "read",  "open",
                                        "sync",     "close", "rename"};

std::atomic<long> counts[kKinds];
std::atomic<bool> counting = false;
Kind failing = kKinds;
long failing_at = 0;
int error_number = 0;
bool goes_on = false;
bool is_short = false;

// The code of libraries that are spared, and of the program.
struct Code {
  std::uintptr_t begin = 0, end = 0;
  [[nodiscard]] bool has(const void* caller) const {
    const auto address = reinterpret_cast<std::uintptr_t>(caller);
    return address >= begin && address < end;
  }
};
constexpr int kMostSpared = 64;
Code spared[kMostSpared];
int spared_count = 0;
Code program;

int note_code(dl_phdr_info* object, std::size_t /*size*/, void* /*data*/) {
  bool is_spared = false;
  for (const char* library :
       {"/libudunits2", "/libopenblas", "/libvtk", "/libmatio", "/libhdf5", "/libc.so"}) {
    is_spared = is_spared || std::strstr(object->dlpi_name, library) != nullptr;
  }
  const bool is_program = *object->dlpi_name == '\0' && program.end == 0;
  for (int i = 0; i < object->dlpi_phnum && (is_spared || is_program); ++i) {
    const auto& part = object->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    const auto begin = object->dlpi_addr + part.p_vaddr;
    const Code code{begin, begin + part.p_memsz};
    if (is_program) program = code;
    if (is_spared && spared_count < kMostSpared) spared[spared_count++] = code;
  }
  return 0;
}

bool is_spared(const void* caller) {
  for (int i = 0; i < spared_count; ++i) {
    if (spared[i].has(caller)) return true;
  }
  return false;
}

// Counts a call and tells whether it fails.
bool fails(Kind kind, const void* caller) {
  if (!counting || is_spared(caller)) return false;
  const long number = ++counts[kind];
  if (kind != failing || failing_at == 0) return false;
  if (number != failing_at && !(goes_on && number > failing_at)) return false;
  errno = error_number;
  return true;
}

// Calls of malloc and its like, not of operator new.
bool no_memory(const void* caller) { return !program.has(caller) && fails(kAllocate, caller); }

void* made(std::size_t size, std::size_t alignment, const void* caller) {
  void* place = fails(kAllocate, caller) ? nullptr : __libc_memalign(alignment, size);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// How many of the `count` bytes of a read or write are asked for; -1 where it is interrupted.
ssize_t shortened(std::size_t count, const void* caller) {
  static std::atomic<unsigned> turn = 0;
  if (!is_short || !counting || is_spared(caller)) return static_cast<ssize_t>(count);
  if (turn++ % 2 == 0) {
    errno = EINTR;
    return -1;
  }
  return static_cast<ssize_t>(count > 1 ? count / 2 : count);
}

void leave_counts() {
  const char* file = std::getenv("CHLADNI_FAIL_COUNT");
  if (file == nullptr) return;
  char text[200];
  int used = 0;
  for (const auto& count : counts) {
    used += std::snprintf(text + used, sizeof text - static_cast<std::size_t>(used), "%ld\n",
                          count.load());
  }
  const long number = syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  static_cast<void>(syscall(SYS_write, number, text, used));
  syscall(SYS_close, number);
}

void prepare() {
  const char* call = std::getenv("CHLADNI_FAIL_CALL");
  for (int kind = 0; call != nullptr && kind < kKinds; ++kind) {
    if (std::strcmp(call, kNames[kind]) == 0) failing = static_cast<Kind>(kind);
  }
  const auto number = [](const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? 0L : std::atol(text);
  };
  failing_at = number("CHLADNI_FAIL_AT");
  error_number = static_cast<int>(number("CHLADNI_FAIL_ERROR"));
  goes_on = std::getenv("CHLADNI_FAIL_ON") != nullptr;
  is_short = std::getenv("CHLADNI_FAIL_SHORT") != nullptr;
}

using Main = int(int, char**, char**);
Main* real_main = nullptr;

// What comes after main() is not counted: no answer can depend on it.
int counted_main(int count, char** words, char** environment) {
  prepare();
  dl_iterate_phdr(note_code, nullptr);
  counting = true;
  const int status = real_main(count, words, environment);
  counting = false;
  leave_counts();
  return status;
}

}  // namespace

extern "C" {

int __libc_start_main(Main* main, int count, char** words, void (*init)(), void (*fini)(),
                      void (*linker_fini)(), void* stack_end) {
  real_main = main;
  using Start = int(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next<Start>("__libc_start_main")(counted_main, count, words, init, fini, linker_fini,
                                          stack_end);
}

// The program itself, with another kernel of OpenBLAS, is still the one that is meant.
int execv(const char* path, char* const* words) {
  counting = false;
  if (std::strcmp(path, "/proc/self/exe") != 0) unsetenv("LD_PRELOAD");
  return execve(path, words, environ);
}

void* malloc(std::size_t size) {
  return no_memory(__builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return no_memory(__builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  return no_memory(__builtin_return_address(0)) ? nullptr : __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return no_memory(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** place, std::size_t alignment, std::size_t size) {
  if (no_memory(__builtin_return_address(0))) return ENOMEM;
  *place = __libc_memalign(alignment, size);
  return *place == nullptr ? ENOMEM : 0;
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  if (fails(kWrite, __builtin_return_address(0))) return -1;
  const auto asked = shortened(count, __builtin_return_address(0));
  return asked < 0 ? -1 : syscall(SYS_write, file, bytes, asked);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  return fails(kWrite, __builtin_return_address(0)) ? -1
                                                    : syscall(SYS_pwrite64, file, bytes, count, at);
}
ssize_t writev(int file, const iovec* parts, int count) {
  if (fails(kWrite, __builtin_return_address(0))) return -1;
  if (is_short && shortened(0, __builtin_return_address(0)) < 0) return -1;
  return syscall(SYS_writev, file, parts, count);
}
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* stream) {
  static const auto real = next<decltype(fwrite)>("fwrite");
  return fails(kWrite, __builtin_return_address(0)) ? 0 : real(bytes, size, count, stream);
}
int putc(int byte, FILE* stream) {
  return fails(kWrite, __builtin_return_address(0)) ? EOF : fputc(byte, stream);
}

ssize_t read(int file, void* bytes, std::size_t count) {
  if (fails(kRead, __builtin_return_address(0))) return -1;
  const auto asked = shortened(count, __builtin_return_address(0));
  return asked < 0 ? -1 : syscall(SYS_read, file, bytes, asked);
}
ssize_t pread(int file, void* bytes, std::size_t count, off_t at) {
  return fails(kRead, __builtin_return_address(0)) ? -1
                                                   : syscall(SYS_pread64, file, bytes, count, at);
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (fails(kOpen, __builtin_return_address(0))) return -1;
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
FILE* fopen(const char* path, const char* mode) {
  static const auto real = next<decltype(fopen)>("fopen");
  return fails(kOpen, __builtin_return_address(0)) ? nullptr : real(path, mode);
}
FILE* fopen64(const char* path, const char* mode) __attribute__((alias("fopen")));

int close(int file) {
  const bool failed =
      fails(kClose, __builtin_return_address(0));  // it is closed all the same, as by Linux
  const auto result = static_cast<int>(syscall(SYS_close, file));
  return failed ? -1 : result;
}
int fsync(int file) {
  return fails(kSync, __builtin_return_address(0)) ? -1
                                                   : static_cast<int>(syscall(SYS_fsync, file));
}
int rename(const char* from, const char* to) {
  return fails(kRename, __builtin_return_address(0))
             ? -1
             : static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

}  // extern "C"

void* operator new(std::size_t size) { return made(size, 16, __builtin_return_address(0)); }
void* operator new[](std::size_t size) { return made(size, 16, __builtin_return_address(0)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return made(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return made(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t /*size*/) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t /*size*/) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t /*alignment*/) noexcept { std::free(place); }
void operator delete[](void* place, std::align_val_t /*alignment*/) noexcept { std::free(place); }
