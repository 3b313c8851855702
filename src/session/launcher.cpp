#include "session/launcher.h"

#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
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

/// Linux's struct sched_attr (sched_setattr(2)), which glibc 2.36 has no header for.
struct SchedulingAttributes {
  std::uint32_t size = sizeof(SchedulingAttributes), policy = 0;
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t runtime = 0;  ///< of an ordinary process: the length of its turns [ns], since 6.12
  std::uint64_t deadline = 0, period = 0;
};

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

void ask_for_short_turns() {
  constexpr std::uint64_t shortest = 100'000;  // [ns]
  SchedulingAttributes own;
  if (::syscall(SYS_sched_getattr, 0, &own, sizeof own, 0) != 0 || own.policy != SCHED_OTHER)
    return;
  own.runtime = shortest;
  (void)::syscall(SYS_sched_setattr, 0, &own, 0);
}

}  // namespace floe
