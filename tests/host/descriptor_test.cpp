#include "host/descriptor.h"

#include <gtest/gtest.h>

#include <cerrno>

#include "base/error.h"

namespace chladni {
namespace {

TEST(PathError, IsAShortageOrABadPlace) {
  for (const int error : {ENOSPC, EDQUOT, EMFILE}) {
    EXPECT_THROW(throw_path_error(error, "no"), OutOfResources) << error;
  }
  for (const int error : {EACCES, ENOTDIR, EROFS}) {
    EXPECT_THROW(throw_path_error(error, "no"), InvalidInput) << error;
  }
}

}  // namespace
}  // namespace chladni
