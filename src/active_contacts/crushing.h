/// \file
/// What the contacts of now have crushed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/pair.h"

namespace floe {

/// What a contact has crushed since the pair touched.
struct Crush {
  std::int32_t a = 0, b = 0;
  Vec3<double> normal_a{}, normal_b{};  ///< n when it last crushed, in the frames of A and B
  double before = 0;                    ///< V_p of the pair before it crushed [m^3]
  double plastic = 0;                   ///< V_p [m^3]

  static constexpr std::size_t numbers = 10;  ///< in a checkpoint
  std::array<double, numbers> as_numbers() const;
  static Crush from(std::span<const double, numbers> n);
};

/// What the counted contacts have crushed, in list order. Contacts that have not crushed anything
/// take no memory here.
class Crushing {
 public:
  /// Begins a commit.
  void start();
  /// Before a commit: gives what a pair has crushed to another pair of the same body.
  void move(const Pair& from, const Pair& to);
  /// Takes over a contact of the commit; contacts come in list order.
  /// \param before  V_p of the pair before the step, or that with which it was born [m^3]
  /// \param after   V_p [m^3]
  /// \param normal  n
  void take(const Pair& pair, double before, double after, const Vec3<double>& normal,
            const Triad<double>& axes_a, const Triad<double>& axes_b);
  /// Ends the commit: what was not taken over has parted.
  void end();
  /// Returns what pairs that parted in the last commit have crushed.
  std::span<const Crush> parted() const { return parted_; }

  /// Returns what pairs that touch have crushed, in list order.
  std::span<const Crush> records() const { return records_; }
  /// Sets it.
  void set(std::vector<Crush> records) { records_ = std::move(records); }
  /// Returns rows of Crush::numbers numbers.
  std::vector<double> rows() const;
  /// Sets what rows() returned. \param here  per body: 1 if this rank owns it
  void restore(std::span<const double> rows, std::span<const std::uint8_t> here);

 private:
  std::vector<Crush> records_, last_, parted_;
  std::size_t next_ = 0;  ///< of last_
};

}  // namespace floe
