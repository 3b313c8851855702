// Runs GoogleTest inside an MPI and PETSc session, in an empty folder of its own; on several ranks
// only rank 0 prints passes, every rank its failures.
#include <gtest/gtest.h>
#include <stdlib.h>  // mkdtemp

#include <filesystem>

#include "base/audit.h"
#include "floe/base/petsc.h"
#include "floe/session/session.h"

#ifdef __SANITIZE_ADDRESS__
/// MPI and PETSc keep what they have until the process ends.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
#endif

namespace {

/// An empty folder, the current one of all ranks: tests that run at the same time must not meet in
/// the names of their files.
class OwnFolder {
 public:
  OwnFolder() {
    std::string name = std::filesystem::temp_directory_path() / "floe_test_XXXXXX";
    int length = static_cast<int>(name.size());
    if (floe::rank() == 0 && mkdtemp(name.data()) == nullptr) length = 0;
    MPI_Bcast(&length, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (length == 0) throw std::runtime_error("cannot make a folder like " + name);
    MPI_Bcast(name.data(), length, MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name;
    std::filesystem::current_path(path_);
    setenv("TEST_TMPDIR", (name + "/").c_str(), 1);  // testing::TempDir()
  }
  ~OwnFolder() {
    std::error_code ignored;
    std::filesystem::current_path(path_.parent_path(), ignored);
    MPI_Barrier(MPI_COMM_WORLD);
    if (floe::rank() == 0) std::filesystem::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

 private:
  std::filesystem::path path_;
};

/// Failures as lines on standard error, for ranks that print nothing else.
class FailuresOnly : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::fprintf(stderr, "rank %d: %s:%d: %s\n", floe::rank(),
                   result.file_name() ? result.file_name() : "?", result.line_number(),
                   result.message());
  }
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();  // ctest asks often
  floe::Mpi mpi(argc, argv);
  int failed = 0;
  {
    floe::Session session(argv[0]);
    floe::set_auditing(true);
    const OwnFolder folder;
    if (floe::rank() != 0) {
      auto& listeners = testing::UnitTest::GetInstance()->listeners();
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailuresOnly);
    }
    const int mine = RUN_ALL_TESTS();
    MPI_Allreduce(&mine, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  }
  return failed;
}
