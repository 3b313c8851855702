/// \file
/// PETSc's options of one run, in a process that makes several runs.
#pragma once

#include "floe/options/given.h"

namespace floe {

/// The options of PETSc's families that a run was given, in a table of their own. Nothing of it is
/// seen outside the life of a Use object.
class SolverOptions {
 public:
  /// \throws InputError for a refused value, and for options on which PETSc acts once in a process
  ///   only (-log_view, -malloc_debug, -info, ...); of the environment these are left out
  explicit SolverOptions(const UserOptions& user);
  ~SolverOptions();
  SolverOptions(const SolverOptions&) = delete;
  SolverOptions& operator=(const SolverOptions&) = delete;

  /// While it lives, these options are those that PETSc finds. Objects nest: the last one counts.
  class Use {
   public:
    /// \param options  must outlive this object
    explicit Use(SolverOptions& options);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    SolverOptions& options_;
  };

 private:
  void* table_ = nullptr;  ///< PetscOptions
  GivenOptions given_;
  bool good_ = true;  ///< whether a first solve has used all of them
};

}  // namespace floe
