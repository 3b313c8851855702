// Whatever release of PETSc is installed: every option that its solvers and floe's own types ask
// for is known as one of PETSc's. PETSc tells by its -help.
#include <gtest/gtest.h>
#include <petscts.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <regex>
#include <set>
#include <string>

#include "explicit/leapfrog.h"
#include "floe/base/petsc.h"
#include "implicit/liealpha.h"
#include "options/option_names.h"
#include "support/implicit_run.h"

namespace floe::test {
namespace {

std::string said;  // NOLINT: PETSc prints all it says by a function that can be replaced

PetscErrorCode listen(std::FILE*, const char* format, std::va_list words) noexcept {
  std::array<char, 8192> text{};
  std::vsnprintf(text.data(), text.size(), format, words);
  said += text.data();
  return PetscErrorCode{0};
}

/// Names of the options that are asked for while this lives, from their help. PETSc gives help once
/// for each prefix, so every listener has a prefix of its own for its objects.
class Listener {
 public:
  Listener() : prefix_("t" + std::to_string(++count) + "_"), before_(PetscVFPrintf) {
    said.clear();
    PetscVFPrintf = listen;
  }
  ~Listener() { PetscVFPrintf = before_; }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  const char* prefix() const { return prefix_.c_str(); }
  /// Without the prefix.
  std::set<std::string> names() const {
    const std::regex line("(^|\\n) *-" + prefix_ + "([A-Za-z]\\w*)");
    std::set<std::string> found;
    for (auto at = std::sregex_iterator(said.begin(), said.end(), line);
         at != std::sregex_iterator(); ++at)
      found.insert((*at)[2]);
    return found;
  }

 private:
  inline static int count = 0;
  std::string prefix_;
  decltype(PetscVFPrintf) before_;
  const PetscOption help_{"-help", ""};
};

/// A string of n masses held at its ends.
void spring(Mat* matrix, PetscInt n) {
  check(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 3, nullptr, matrix));
  check(MatSetOption(*matrix, MAT_SPD, PETSC_TRUE));
  check(MatSetFromOptions(*matrix));
  for (PetscInt k = 0; k < n; ++k) {
    for (const PetscInt l : {k - 1, k, k + 1}) {
      if (l >= 0 && l < n) check(MatSetValue(*matrix, k, l, k == l ? 2.0 : -1.0, INSERT_VALUES));
    }
  }
  check(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
}

void expect_known(const Listener& listener, const std::string& type, const char* one_of_them) {
  const auto names = listener.names();
  EXPECT_TRUE(names.contains(one_of_them)) << type << " did not ask for " << one_of_them;
  for (const std::string& name : names) EXPECT_TRUE(is_petsc_option(name)) << type << ": " << name;
}

TEST(PetscOptions, OfLinearSolversAreKnown) {
  for (const char* type :
       {KSPCG, KSPGMRES, KSPFGMRES, KSPBCGS, KSPMINRES, KSPCHEBYSHEV, KSPPREONLY, KSPRICHARDSON}) {
    const Listener listener;
    Handle<KSP> ksp;
    check(KSPCreate(PETSC_COMM_SELF, ksp.put()));
    check(KSPSetOptionsPrefix(ksp, listener.prefix()));
    check(KSPSetType(ksp, type));
    check(KSPSetFromOptions(ksp));
    expect_known(listener, type, "ksp_type");
  }
}

TEST(PetscOptions, OfPreconditionersAndTheirInnerSolversAreKnown) {
  for (const char* type : {PCJACOBI, PCBJACOBI, PCASM, PCGAMG, PCMG, PCILU, PCICC, PCLU, PCCHOLESKY,
                           PCREDUNDANT, PCTELESCOPE, PCKSP, PCSOR, PCEISENSTAT}) {
    const Listener listener;
    Handle<Mat> matrix;
    spring(matrix.put(), 400);
    Handle<KSP> ksp;
    check(KSPCreate(PETSC_COMM_SELF, ksp.put()));
    check(KSPSetOptionsPrefix(ksp, listener.prefix()));
    PC pc = nullptr;
    check(KSPGetPC(ksp, &pc));
    check(PCSetType(pc, type));
    check(KSPSetOperators(ksp, matrix, matrix));
    check(KSPSetFromOptions(ksp));
    check(KSPSetUp(ksp));
    check(PCSetUpOnBlocks(pc));
    expect_known(listener, type, "pc_type");
  }
}

TEST(PetscOptions, OfMumpsAreKnown) {
  const Listener listener;
  Handle<Mat> matrix, factor;
  spring(matrix.put(), 10);
  check(MatGetFactor(matrix, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor.put()));
  check(MatSetOptionsPrefix(factor, listener.prefix()));
  MatFactorInfo info{};
  check(MatFactorInfoInitialize(&info));
  check(MatCholeskyFactorSymbolic(factor, matrix, nullptr, &info));
  expect_known(listener, "mumps", "mat_mumps_icntl_14");
}

TEST(PetscOptions, OfNonlinearSolversAreKnown) {
  for (const char* type : {SNESNEWTONLS, SNESNEWTONTR, SNESNRICHARDSON, SNESKSPONLY, SNESNCG,
                           SNESQN, SNESNGMRES, SNESFAS}) {
    const Listener listener;
    Handle<SNES> snes;
    check(SNESCreate(PETSC_COMM_SELF, snes.put()));
    check(SNESSetOptionsPrefix(snes, listener.prefix()));
    check(SNESSetType(snes, type));
    check(SNESSetFromOptions(snes));
    expect_known(listener, type, "snes_rtol");
  }
}

TEST(PetscOptions, OfSteppersAreKnown) {
  register_leapfrog();
  register_liealpha();
  for (const char* type : {ts_leapfrog, ts_liealpha, TSRK, TSALPHA2}) {
    const Listener listener;
    Handle<TS> ts;
    check(TSCreate(PETSC_COMM_SELF, ts.put()));
    check(TSSetOptionsPrefix(ts, listener.prefix()));
    check(TSSetType(ts, type));
    TSAdapt adapt = nullptr;
    check(TSGetAdapt(ts, &adapt));
    check(TSAdaptSetType(adapt, TSADAPTBASIC));
    check(TSSetFromOptions(ts));
    expect_known(listener, type, "ts_max_time");
    const bool of_liealpha = said.find("ts_liealpha_radius") != std::string::npos;
    EXPECT_EQ(of_liealpha, std::string(type) == ts_liealpha);
  }
}

}  // namespace
}  // namespace floe::test
