/// \file
/// A lattice distributed over ranks. Each rank owns a chunk or a strip of the bodies and computes
/// every beam that touches an owned body, in global order, so that forces have the same bits for
/// any number of ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/ghosts.h"
#include "floe/lattice/lattice.h"

namespace floe {

/// The bodies and beams of one rank. Local bodies are the owned ones in global order, then the
/// ghosts by (owner, global index).
struct Part {
  MPI_Comm comm = MPI_COMM_NULL;
  std::int32_t global_bodies = 0;
  std::int64_t global_beams = 0;
  std::int32_t owned = 0;  ///< number of owned bodies
  std::int32_t local = 0;  ///< owned + ghosts

  std::vector<std::int32_t> global;  ///< per local body: its index in the lattice
  std::vector<std::int32_t> row;     ///< per local body: its block row in PETSc's numbering
  Bodies bodies;                     ///< of local bodies

  Beams beams;  ///< beams that touch an owned body, local indices, in global order
  std::vector<std::int32_t> global_beam;  ///< per local beam: its index in the lattice
  /// per local beam: whether this rank owns bodies[0], and therefore counts the beam's energy
  std::vector<std::uint8_t> counts_here;

  Shapes shapes;  ///< of owned bodies; empty if the lattice has none
  Ghosts ghosts;

  /// Returns the local indices of the bodies of a global set that are local here, ghosts included.
  std::vector<std::int32_t> localise(const std::vector<std::int32_t>& global_set) const;
  /// Returns the local index of a global body, or -1.
  std::int32_t local_index(std::int32_t global_body) const;

 private:
  friend Part partition(const Lattice&, MPI_Comm, const std::vector<std::int32_t>&);
  std::vector<std::int32_t> local_of_;  ///< per global body: local index or -1
};

/// Distributes a lattice, which must be the same on every rank. Collective.
/// \param strips  direction in plan along which the work will gather, as that to an obstacle: ranks
///                own strips along it, of equal numbers of bodies, so that each has its share of
///                the pile. Zero, or strips less than four bodies wide: chunks along a Hilbert
///                curve, which have fewer neighbours
/// \throws InputError if there are more ranks than bodies
Part partition(const Lattice& lattice, MPI_Comm comm, const Vec3<double>& strips = {});
/// Does the same by given owners. \param owner  per body: its rank; each rank owns one at least
Part partition(const Lattice& lattice, MPI_Comm comm, const std::vector<std::int32_t>& owner);

/// Returns the owner of each body, by strips or chunks as partition(), of equal loads.
/// \param places  of the bodies [m]
/// \param loads   per body, in any unit; empty: all bodies are alike
/// \throws InputError if there are more ranks than bodies
std::vector<std::int32_t> owners_by_load(const std::vector<Point3>& places,
                                         const std::vector<double>& loads, int ranks,
                                         const Vec3<double>& strips);

/// Returns the order of points along a Hilbert curve in the box that holds them. The box may be
/// flat.
std::vector<std::int32_t> hilbert_order(const std::vector<Point3>& points);

}  // namespace floe
