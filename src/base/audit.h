/// \file
/// A comparison over ranks of data that must be alike on all ranks. PETSc caches norms by an
/// object's state: if only some ranks opened a vector for writing, these take part in the sum of
/// the next norm, the others do not, and the run hangs. The audit finds the error where it happens.
#pragma once

#include <petsc.h>

#include <span>

namespace floe {

/// Whether ranks are compared: in builds with FLOE_AUDIT (the preset `audit`) and in tests that
/// switch the comparison on. A comparison costs messages in every step.
bool auditing();
void set_auditing(bool on);

/// Compares the states of objects (null pointers included) and numbers over all ranks, to the last
/// bit, if auditing(). Collective if auditing().
/// \param where  name of the place, for the message
/// \throws std::logic_error on all ranks, naming the first object or number that differs
void audit(MPI_Comm comm, const char* where, std::span<const PetscObject> objects,
           std::span<const double> numbers = {});

inline PetscObject object_of(Vec vec) { return reinterpret_cast<PetscObject>(vec); }
inline PetscObject object_of(Mat mat) { return reinterpret_cast<PetscObject>(mat); }

}  // namespace floe
