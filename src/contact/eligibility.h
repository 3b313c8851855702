/// \file
/// Which bodies may touch, by the beams that join them (model.md, "Contact").
#pragma once

#include <cstdint>
#include <vector>

#include "contact/pair.h"
#include "contact/solids.h"
#include "floe/base/item.h"

namespace floe {

/// Bodies of different pieces may touch. Bodies of one piece may touch if both are on its surface
/// and no beam joins them. A body is on the surface if it has fewer beams than a prism has sides,
/// or if it has lost a beam.
class Eligibility {
 public:
  /// \param joined  pairs with an unbroken beam, sorted, the smaller index first
  Eligibility(const Solids& solids, std::vector<BodyPair> joined);

  /// Separates a pair whose beam broke; pieces and surfaces follow with update().
  /// \returns whether the beam was still counted as unbroken
  bool release(BodyPair pair);
  /// Finds the pieces and their surfaces.
  void update(const Solids& solids);

  bool may_touch(std::int32_t a, std::int32_t b) const;
  /// Whether a pair that may touch became eligible by the last update(): before it might not.
  bool became_eligible(std::int32_t a, std::int32_t b) const;
  /// Whether a beam between two bodies, the smaller index first, broke before the last update().
  bool beam_broke(const BodyPair& pair) const;
  /// Returns the smallest body of the piece of a body.
  std::int32_t piece(std::int32_t body) const { return item(piece_, body); }
  /// Returns the pairs with an unbroken beam, sorted.
  const std::vector<BodyPair>& joined() const { return joined_; }
  bool on_surface(std::int32_t body) const { return item(on_surface_, body) != 0; }
  /// Returns the number of pieces as of the last update().
  std::int32_t pieces() const { return pieces_; }
  /// Returns the pairs whose beam broke, in the order of release().
  const std::vector<BodyPair>& released() const { return released_; }
  /// Returns the number of these that the last update() knew.
  std::size_t known() const { return broken_.size(); }

 private:
  std::vector<BodyPair> joined_, released_;
  std::vector<BodyPair> broken_;  ///< released before the last update, sorted
  std::vector<BodyPair> fresh_;   ///< those of them that the update before did not know, sorted
  std::vector<std::int32_t> piece_, piece_before_;  ///< per body: the smallest body of its piece
  std::vector<std::uint8_t> on_surface_, on_surface_before_;  ///< per body
  std::int32_t pieces_ = 0;
};

}  // namespace floe
