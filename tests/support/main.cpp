// Runs GoogleTest inside an MPI and PETSc session; on several ranks only rank 0 prints passes,
// every rank its failures.
#include <gtest/gtest.h>

#include "floe/base/petsc.h"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  floe::Mpi mpi(argc, argv);
  int failed = 0;
  {
    floe::Session session(argv[0]);
    if (floe::rank() != 0) {
      auto& listeners = testing::UnitTest::GetInstance()->listeners();
      delete listeners.Release(listeners.default_result_printer());
      class FailuresOnly : public testing::EmptyTestEventListener {
        void OnTestPartResult(const testing::TestPartResult& result) override {
          if (result.failed())
            std::fprintf(stderr, "rank %d: %s:%d: %s\n", floe::rank(),
                         result.file_name() ? result.file_name() : "?", result.line_number(),
                         result.message());
        }
      };
      listeners.Append(new FailuresOnly);
    }
    const int mine = RUN_ALL_TESTS();
    MPI_Allreduce(&mine, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  }
  return failed;
}
