/// \file
/// What must be alike on all ranks. PETSc keeps norms by an object's state: where only some ranks
/// opened a vector for writing, those take part in the next norm's sum and the others do not, and
/// the run hangs. An audit finds that where it happens.
#pragma once

#include <petsc.h>

#include <span>

namespace floe {

/// Whether ranks are compared: in builds with FLOE_AUDIT (the preset `audit`) and where tests
/// switch it on. Costs messages at every step.
bool auditing();
void set_auditing(bool on);

/// Compares on all ranks the states of objects (null ones too) and numbers, to the last bit, if
/// auditing(). Collective then. \param where  for the message
/// \throws std::logic_error on all ranks, naming the first that differs
void audit(MPI_Comm comm, const char* where, std::span<const PetscObject> objects,
           std::span<const double> numbers = {});

inline PetscObject object_of(Vec vec) { return reinterpret_cast<PetscObject>(vec); }
inline PetscObject object_of(Mat mat) { return reinterpret_cast<PetscObject>(mat); }

}  // namespace floe
