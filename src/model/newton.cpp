#include "model/newton.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "base/collectives.h"

namespace floe {

TangentOptions tangent_options() {
  char pc[64] = "cholesky";
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, "-pc_type", pc, sizeof pc, &given));
  TangentOptions options;
  if (std::strcmp(pc, PCCHOLESKY) != 0) options.type = MATAIJ;
  options.symmetric = std::strcmp(pc, PCLU) != 0;
  return options;
}

template <class Space>
double typical_stiffness(const Model<Space>& model) {
  double most = 0;
  for (std::int32_t b = 0; b < model.part().owned; ++b) {
    for (const auto& force : model.forces()) {
      if (const auto* role = force->roles().step) most = std::max(most, role->stiffness_bound(b));
    }
  }
  most = largest_over_ranks(most, model.part().comm);
  return most > 0 ? most : 1.0;
}

void set_cholesky(KSP ksp) {
  claim_blas_memory();
  PC pc = nullptr;
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void set_newton_defaults(SNES snes) {
  check(SNESSetType(snes, SNESNEWTONLS));
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes, &search));
  // A line search would reject good steps: where beams stretch, |F| grows on the way to the
  // solution.
  check(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
  KSP ksp = nullptr;
  check(SNESGetKSP(snes, &ksp));
  set_cholesky(ksp);
}

template <class Space>
void attach_rigid_modes(const Model<Space>& model, std::span<const std::uint8_t> held, Mat matrix) {
  constexpr std::size_t n = Space::unknowns;
  const Part& part = model.part();
  std::array<Handle<Vec>, n> modes;
  std::vector<Vec> list;
  for (std::size_t k = 0; k < n; ++k) {
    const int m = Space::components[k];
    auto& mode = modes[k];
    check(MatCreateVecs(matrix, mode.put(), nullptr));
    PetscScalar* values = nullptr;
    check(VecGetArrayWrite(mode, &values));
    for (std::int32_t body = 0; body < part.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      const Vec3<double> axis{m % 3 == 0 ? 1.0 : 0.0, m % 3 == 1 ? 1.0 : 0.0,
                              m % 3 == 2 ? 1.0 : 0.0};
      const Vec3<double> turn = m < 3 ? Vec3<double>{0, 0, 0} : axis;
      const Vec3<double> u = m < 3 ? axis : cross(axis, part.bodies.position[b]);
      const double l = model.length_scale();
      const std::array<double, 6> entries{u.x, u.y, u.z, l * turn.x, l * turn.y, l * turn.z};
      for (std::size_t a = 0; a < n; ++a) {
        const auto component = static_cast<std::size_t>(Space::components[a]);
        values[b * n + a] = (held[b] >> a & 1U) != 0 ? 0.0 : entries[component];
      }
    }
    check(VecRestoreArrayWrite(mode, &values));
    for (const Vec earlier : list) {
      PetscScalar along = 0;
      check(VecDot(mode, earlier, &along));
      check(VecAXPY(mode, -along, earlier));
    }
    PetscReal norm = 0;
    check(VecNorm(mode, NORM_2, &norm));
    if (norm < 1e-10) continue;  // all of this mode is held
    check(VecScale(mode, 1.0 / norm));
    list.push_back(mode);
  }
  Handle<MatNullSpace> space;
  check(MatNullSpaceCreate(part.comm, PETSC_FALSE, static_cast<PetscInt>(list.size()), list.data(),
                           space.put()));
  check(MatSetNearNullSpace(matrix, space));
}

Mat mumps_cholesky(KSP ksp) {
  PC pc = nullptr;
  Mat factor = nullptr;
  MatSolverType package = nullptr;
  PetscBool cholesky = PETSC_FALSE;
  check(KSPGetPC(ksp, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &cholesky));
  if (cholesky == PETSC_FALSE) return nullptr;
  check(PCFactorGetMatSolverType(pc, &package));
  if (package == nullptr || std::strcmp(package, MATSOLVERMUMPS) != 0) return nullptr;
  check(PCFactorSetUpMatSolverType(pc));
  check(PCFactorGetMatrix(pc, &factor));
  return factor;
}

void let_mumps_count(KSP ksp) {
  constexpr PetscInt root_front = 13;  // MUMPS users' guide, ICNTL(13)
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(ksp), &comm));
  if (size(comm) == 1) return;
  if (Mat factor = mumps_cholesky(ksp)) check(MatMumpsSetIcntl(factor, root_front, 1));
}

bool drop_failed_factor(KSP ksp) {
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  check(KSPGetPC(ksp, &pc));
  check(PCGetFailedReason(pc, &reason));
  // Some preconditioners report the reason of one rank's part only.
  if (!on_any_rank(reason != PC_NOERROR, PetscObjectComm(reinterpret_cast<PetscObject>(pc))))
    return false;
  check(PCReset(pc));
  return true;
}

std::int64_t negative_pivots(KSP ksp) {
  const Mat factor = mumps_cholesky(ksp);
  if (factor == nullptr) return -1;
  check(KSPSetUp(ksp));
  PetscInt negative = 0;
  constexpr PetscInt number_of_negative_pivots = 12;  // MUMPS users' guide, INFOG(12)
  check(MatMumpsGetInfog(factor, number_of_negative_pivots, &negative));
  return negative;
}

namespace {

/// Whether an error of MUMPS means too little memory or workspace (MUMPS users' guide, INFOG(1)).
bool is_want_of_memory(PetscInt infog) {
  constexpr std::array<PetscInt, 9> codes{-5, -7, -8, -9, -11, -13, -17, -19, -20};
  return std::find(codes.begin(), codes.end(), infog) != codes.end();
}

}  // namespace

void require_memory(KSP ksp) {
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  check(KSPGetPC(ksp, &pc));
  check(PCGetFailedReason(pc, &reason));
  if (reason == PC_NOERROR) return;
  std::string text = "out of memory: the factorisation of the tangent needs more";
  if (const Mat factor = mumps_cholesky(ksp)) {
    std::array<PetscInt, 2> info{};
    check(MatMumpsGetInfog(factor, 1, &info[0]));
    check(MatMumpsGetInfog(factor, 2, &info[1]));
    if (!is_want_of_memory(info[0])) return;
    text += " (MUMPS says INFOG(1) = " + std::to_string(info[0]) +
            ", INFOG(2) = " + std::to_string(info[1]) + ")";
    constexpr PetscInt of_its_workspace = -9;
    if (info[0] == of_its_workspace) text += "; -mat_mumps_icntl_14 100 lets it take more";
  } else if (reason != PC_FACTOR_OUTMEMORY) {
    return;
  }
  throw RunFailed(text +
                  "; -ksp_type cg -pc_type gamg needs less, as do more ranks on more machines");
}

void claim_blas_memory() {
  static const bool done = [] {
    // OpenBLAS maps 128 MB of addresses when it first needs buffers, keeps them, and retries for
    // ever if the mapping fails.
    constexpr std::size_t needed = 160U << 20;
    void* room = ::mmap(nullptr, needed, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) throw std::bad_alloc();
    ::munmap(room, needed);
    // A blocked factorisation makes OpenBLAS allocate these buffers.
    constexpr PetscInt n = 256;
    Handle<Mat> dense;
    MatFactorInfo info{};
    check(MatCreateSeqDense(PETSC_COMM_SELF, n, n, nullptr, dense.put()));
    check(MatShift(dense, 1.0));
    check(MatFactorInfoInitialize(&info));
    check(MatLUFactor(dense, nullptr, nullptr, &info));
    return true;
  }();
  (void)done;
}

template double typical_stiffness(const Model<Spatial>&);
template double typical_stiffness(const Model<Planar>&);
template void attach_rigid_modes(const Model<Spatial>&, std::span<const std::uint8_t>, Mat);
template void attach_rigid_modes(const Model<Planar>&, std::span<const std::uint8_t>, Mat);

}  // namespace floe
