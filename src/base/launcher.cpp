#include "launcher.h"

#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace floe {
namespace {

/// Whether a launcher (mpiexec, srun) may have started this process.
bool has_launcher() {
  for (const char* name :
       {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_FD", "SLURM_PROCID"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

}  // namespace

void prepare_one_process() {
  // MUMPS polls MPI for messages all the time. One process has no other rank to yield to; with
  // yielding switched on (tools/env) it would hand its time slices to other programs of the
  // machine.
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (size == nullptr || std::strcmp(size, "1") == 0)
    setenv("OMPI_MCA_mpi_yield_when_idle", "0", 1);
  if (has_launcher()) return;
  // Without the daemon that starts further processes and without the search for networks the start
  // takes 0.1 s instead of 0.5. The session folder is switched off too: processes that start at the
  // same time would share it, and one in 40 aborted because another had removed it.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
}

}  // namespace floe
