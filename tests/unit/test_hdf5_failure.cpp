// HDF5 files that cannot be written to the end.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <vector>

#include "files/hdf5.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

constexpr int given_up = 7, not_given_up = 8;

/// Drops an open file, as an exception does, when nothing more can be written.
/// \returns to the process that asks: by an exit code, whether MPI is given up
[[noreturn]] void drop_a_file(bool can_be_written) {
  std::signal(SIGXFSZ, SIG_IGN);
  {
    Hdf5File file = Hdf5File::create("dropped.h5");
    file.write("/numbers", std::vector<double>(100, 1.0));
    const rlimit none{0, 0};
    if (!can_be_written) setrlimit(RLIMIT_FSIZE, &none);
  }
  std::_Exit(mpi_is_given_up() ? given_up : not_given_up);
}

/// HDF5 would try again, and crash, when MPI ends.
TEST(Hdf5File, ThatIsDroppedOnAFullDiskGivesUpOnMpi) {
  EXPECT_EXIT(drop_a_file(false), testing::ExitedWithCode(given_up), "");
  EXPECT_EXIT(drop_a_file(true), testing::ExitedWithCode(not_given_up), "");
}

}  // namespace
}  // namespace floe
