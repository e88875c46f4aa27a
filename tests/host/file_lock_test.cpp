#include "host/file_lock.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>

#include "host/descriptor.h"

namespace chladni {
namespace {

TEST(FileLock, IsHeldOnce) {
  const auto file = testing::TempDir() + "chladni_file_lock";
  const Descriptor first(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  const Descriptor second(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  EXPECT_EQ(tried_lock(first.number()), FileLock::held);
  EXPECT_EQ(tried_lock(second.number()), FileLock::elsewhere);
  std::filesystem::remove(file);
}

// Lustre and NFS may have no locks: that is not a lock of somebody else.
TEST(FileLock, IsMissingOnSomeFileSystems) {
  for (const int error : {ENOSYS, ENOLCK, EOPNOTSUPP}) {
    EXPECT_EQ(lock_after(error), FileLock::none) << error;
  }
}

}  // namespace
}  // namespace chladni
