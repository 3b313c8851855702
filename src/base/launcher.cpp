#include "launcher.h"

#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace floe {
namespace {

/// Whether somebody else started this process as one of several, or may have: mpiexec, srun.
bool has_launcher() {
  for (const char* name :
       {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_FD", "SLURM_PROCID"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

}  // namespace

void prepare_one_process() {
  // MUMPS asks MPI for messages all the time. One process has nobody to give way to; told to yield
  // (tools/env), it would hand each of its time slices to whatever else the machine runs.
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (size == nullptr || std::strcmp(size, "1") == 0)
    setenv("OMPI_MCA_mpi_yield_when_idle", "0", 1);
  if (has_launcher()) return;
  // No daemon that could start further processes and no search for networks: 0.1 s instead of 0.5.
  // No session folder either: those that start at the same time would share it, and one in 40
  // aborted when another had removed it.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
}

}  // namespace floe
