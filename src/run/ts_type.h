/// \file
/// PETSc's private TS header for floe's own TS types, which have no other access to a TS. The
/// layout may change with any release, so the types of all members used are checked here at compile
/// time, and test_ts_types.cpp runs both TS types.
#pragma once

#include <petsc/private/tsimpl.h>

#include <type_traits>

namespace floe {

template <class Function>
struct SecondArgument;
template <class Result, class First, class Second>
struct SecondArgument<Result (*)(First, Second)> {
  using type = Second;
};

/// Argument of setfromoptions: PetscOptionItems* up to PETSc 3.22, then PetscOptionItems, which is
/// a pointer itself since.
using TsOptionItems = SecondArgument<decltype(_TSOps::setfromoptions)>::type;
static_assert(std::is_pointer_v<TsOptionItems>);

template <class Member, class Expected>
concept Holds = std::is_same_v<Member, Expected>;

// Functions of a TS type.
using TsFunction = PetscErrorCode (*)(TS);
static_assert(Holds<decltype(_TSOps::setup), TsFunction>);
static_assert(Holds<decltype(_TSOps::step), TsFunction>);
static_assert(Holds<decltype(_TSOps::reset), TsFunction>);
static_assert(Holds<decltype(_TSOps::destroy), TsFunction>);
static_assert(Holds<decltype(_TSOps::setfromoptions), PetscErrorCode (*)(TS, TsOptionItems)>);
static_assert(Holds<decltype(_TSOps::view), PetscErrorCode (*)(TS, PetscViewer)>);
static_assert(Holds<decltype(_TSOps::snesfunction), PetscErrorCode (*)(SNES, Vec, Vec, TS)>);
static_assert(Holds<decltype(_TSOps::snesjacobian), PetscErrorCode (*)(SNES, Vec, Mat, Mat, TS)>);
static_assert(
    Holds<decltype(_TSOps::evaluatewlte), PetscErrorCode (*)(TS, NormType, PetscInt*, PetscReal*)>);

// Members that a TS type reads and writes.
static_assert(Holds<decltype(_p_TS::data), void*>);
static_assert(Holds<decltype(_p_TS::vec_sol), Vec>);
static_assert(Holds<decltype(_p_TS::vec_dot), Vec>);
static_assert(Holds<decltype(_p_TS::snes), SNES>);
static_assert(Holds<decltype(_p_TS::usessnes), PetscBool>);
static_assert(Holds<decltype(_p_TS::adapt), TSAdapt>);
static_assert(Holds<decltype(_p_TS::default_adapt_type), TSAdaptType>);
static_assert(Holds<decltype(_p_TS::ptime), PetscReal>);
static_assert(Holds<decltype(_p_TS::time_step), PetscReal>);
static_assert(Holds<decltype(_p_TS::steprestart), PetscBool>);
static_assert(Holds<decltype(_p_TS::reason), TSConvergedReason>);
static_assert(Holds<decltype(_p_TS::snes_its), PetscInt>);
static_assert(Holds<decltype(_p_TS::ksp_its), PetscInt>);
static_assert(Holds<decltype(_p_TS::reject), PetscInt>);
static_assert(Holds<decltype(_p_TS::max_reject), PetscInt>);
static_assert(Holds<decltype(_p_TS::atol), PetscReal>);
static_assert(Holds<decltype(_p_TS::rtol), PetscReal>);
static_assert(Holds<decltype(_p_TSAdapt::timestepjustdecreased), PetscInt>);

}  // namespace floe
