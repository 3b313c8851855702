#include "explicit/leapfrog.h"

#include "run/ts_type.h"

namespace floe {
namespace {

PetscErrorCode step(TS ts) noexcept {
  auto& work = **static_cast<LeapfrogStep**>(ts->data);
  if (!work(ts->time_step)) {
    ts->reason = TS_DIVERGED_STEP_REJECTED;
    return 0;
  }
  ts->ptime += ts->time_step;
  return PetscObjectStateIncrease(reinterpret_cast<PetscObject>(ts->vec_sol));
}

PetscErrorCode destroy(TS ts) noexcept { return PetscFree(ts->data); }
PetscErrorCode nothing(TS) noexcept { return 0; }
PetscErrorCode no_options(TS, TsOptionItems) noexcept { return 0; }
PetscErrorCode view(TS, PetscViewer viewer) noexcept {
  return PetscViewerASCIIPrintf(viewer, "  velocities half a step behind positions, fixed step\n");
}

PetscErrorCode create(TS ts) noexcept {
  LeapfrogStep** work = nullptr;
  const PetscErrorCode error = PetscNew(&work);
  if (error != 0) return error;
  ts->data = static_cast<void*>(work);
  ts->ops->step = step;
  ts->ops->setup = nothing;
  ts->ops->reset = nothing;
  ts->ops->destroy = destroy;
  ts->ops->setfromoptions = no_options;
  ts->ops->view = view;
  ts->default_adapt_type = TSADAPTNONE;
  ts->usessnes = PETSC_FALSE;
  return 0;
}

}  // namespace

void register_leapfrog() {
  static const bool once = [] {
    check(TSInitializePackage());
    check(TSRegister(ts_leapfrog, create));
    return true;
  }();
  (void)once;
}

void set_leapfrog_step(TS ts, LeapfrogStep* step) { *static_cast<LeapfrogStep**>(ts->data) = step; }

}  // namespace floe
