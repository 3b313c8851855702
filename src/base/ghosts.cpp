#include "base/ghosts.h"

#include <utility>

namespace floe {

Ghosts::Ghosts(MPI_Comm comm, std::int32_t owned, std::span<const std::int32_t> owner,
               std::span<const std::int32_t> remote)
    : owned_(owned),
      ghosts_(static_cast<std::int32_t>(owner.size())),
      alone_(floe::size(comm) == 1) {
  check(PetscSFCreate(comm, sf_.put()));
  std::vector<PetscInt> leaves(owner.size());
  std::vector<PetscSFNode> roots(owner.size());
  for (std::size_t k = 0; k < owner.size(); ++k) {
    leaves[k] = owned + static_cast<PetscInt>(k);
    roots[k].rank = owner[k];
    roots[k].index = remote[k];
  }
  check(PetscSFSetGraph(sf_, owned, static_cast<PetscInt>(owner.size()), leaves.data(),
                        PETSC_COPY_VALUES, roots.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(sf_));
}

Ghosts::Ghosts(Ghosts&& other) noexcept
    : sf_(std::move(other.sf_)),
      owned_(other.owned_),
      ghosts_(other.ghosts_),
      alone_(other.alone_),
      types_(std::exchange(other.types_, {})) {}

Ghosts& Ghosts::operator=(Ghosts&& other) noexcept {
  std::swap(sf_, other.sf_);
  std::swap(owned_, other.owned_);
  std::swap(ghosts_, other.ghosts_);
  std::swap(alone_, other.alone_);
  std::swap(types_, other.types_);
  return *this;
}

Ghosts::~Ghosts() {
  for (auto& [width, type] : types_) MPI_Type_free(&type);
}

MPI_Datatype Ghosts::record_type(int width) const {
  for (const auto& [known, type] : types_) {
    if (known == width) return type;
  }
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(width, MPI_DOUBLE, &type);
  MPI_Type_commit(&type);
  types_.emplace_back(width, type);
  return type;
}

void Ghosts::begin(std::span<double> records, int width) const {
  if (alone_) return;
  check(PetscSFBcastBegin(sf_, record_type(width), records.data(), records.data(), MPI_REPLACE));
}

void Ghosts::end(std::span<double> records, int width) const {
  if (alone_) return;
  check(PetscSFBcastEnd(sf_, record_type(width), records.data(), records.data(), MPI_REPLACE));
}

}  // namespace floe
