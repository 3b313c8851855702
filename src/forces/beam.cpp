#include "floe/forces/beam.h"

#include <algorithm>

#include "forces/beam_spatial.h"

namespace floe {
namespace {

/// Loops over the beams of a part with one pointwise kernel, chosen outside.
template <class Pointwise>
class Beam final : public BeamForce<typename Pointwise::Space> {
 public:
  using Space = typename Pointwise::Space;
  static constexpr int n = Space::unknowns;

  Beam(const Part& part, const BeamOptions& options)
      : part_(part), stiffness_(static_cast<std::size_t>(part.local)) {
    constants_.reserve(static_cast<std::size_t>(part.beams.size()));
    for (std::int32_t m = 0; m < part.beams.size(); ++m) {
      constants_.push_back(Pointwise::make(part, m, options.shear));
      const auto& c = constants_.back();
      const double bound = std::max({c.kn, c.ksy, c.ksz});
      for (const std::int32_t body : part.beams.bodies[static_cast<std::size_t>(m)])
        stiffness_[static_cast<std::size_t>(body)] += bound;
    }
  }

  std::string_view name() const override { return "beam"; }

  void add(const State<Space>& state, Wrenches<Space>& wrenches) const override {
    std::array<double, n> on_i, on_j;
    for (std::size_t m = 0; m < constants_.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[m];
      Pointwise::wrenches(constants_[m], state.record(static_cast<std::size_t>(i)),
                          state.record(static_cast<std::size_t>(j)), on_i.data(), on_j.data());
      if (i < part_.owned) {
        double* w = wrenches.of(static_cast<std::size_t>(i));
        for (int k = 0; k < n; ++k) w[k] += on_i[static_cast<std::size_t>(k)];
      }
      if (j < part_.owned) {
        double* w = wrenches.of(static_cast<std::size_t>(j));
        for (int k = 0; k < n; ++k) w[k] += on_j[static_cast<std::size_t>(k)];
      }
    }
  }

  bool add_tangent(const State<Space>& state, Tangent<Space>& tangent) const override {
    typename Tangent<Space>::PairBlock block;
    for (std::size_t m = 0; m < constants_.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[m];
      Pointwise::tangent(constants_[m], state.record(static_cast<std::size_t>(i)),
                         state.record(static_cast<std::size_t>(j)), tangent.symmetric(), block);
      tangent.add_pair(i, j, block);
    }
    return true;
  }

  double stiffness_bound(std::int32_t body) const override {
    return stiffness_[static_cast<std::size_t>(body)];
  }

  void report(const State<Space>& state, Columns& columns) const override {
    double energy = 0;
    for (std::size_t m = 0; m < constants_.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[m];
      if (part_.counts_here[m])
        energy += Pointwise::energy(constants_[m], state.record(static_cast<std::size_t>(i)),
                                    state.record(static_cast<std::size_t>(j)));
    }
    columns.add("energy_strain", energy);
  }

  std::int64_t folded(const State<Space>& state) const override {
    std::int64_t count = 0;
    for (std::size_t m = 0; m < constants_.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[m];
      count += Pointwise::is_folded(constants_[m], state.record(static_cast<std::size_t>(i)),
                                    state.record(static_cast<std::size_t>(j)));
    }
    return count;
  }

  std::vector<BeamSection> sections(const State<Space>& state) const override {
    std::vector<BeamSection> all(constants_.size());
    for (std::size_t m = 0; m < constants_.size(); ++m) {
      const auto [i, j] = part_.beams.bodies[m];
      all[m] = Pointwise::section(constants_[m], state.record(static_cast<std::size_t>(i)),
                                  state.record(static_cast<std::size_t>(j)));
    }
    return all;
  }

 private:
  const Part& part_;
  std::vector<typename Pointwise::Constants> constants_;
  std::vector<double> stiffness_;
};

}  // namespace

BeamStiffness beam_stiffness(const Beams& beams, std::int32_t m, Shear shear) {
  const auto k = static_cast<std::size_t>(m);
  const double e = beams.young[k], l = beams.length[k], iy = beams.inertia_y[k],
               iz = beams.inertia_z[k];
  const double one_point = beams.shear_factor[k] * beams.shear_modulus[k] * beams.area[k] / l;
  // 12 E I/(l^3 (1 + Phi)) with Phi = 12 E I/(kappa G A l^2): bending and shear in series.
  const auto transverse = [&](double inertia) {
    const double bending = 12.0 * e * inertia / (l * l * l);
    if (shear == Shear::one_point) return one_point;
    if (shear == Shear::none) return bending;
    return bending * one_point / (bending + one_point);
  };
  return {e * beams.area[k] / l,
          transverse(iz),
          transverse(iy),
          beams.shear_modulus[k] * beams.torsion[k] / l,
          e * iy / l,
          e * iz / l};
}

template <class Space>
std::unique_ptr<BeamForce<Space>> make_beam_force(const Part& part, const BeamOptions& options) {
  if (options.kinematics == Kinematics::linear)
    return std::make_unique<Beam<SpatialBeam<Kinematics::linear>>>(part, options);
  return std::make_unique<Beam<SpatialBeam<Kinematics::corotational>>>(part, options);
}

template std::unique_ptr<BeamForce<Spatial>> make_beam_force<Spatial>(const Part&,
                                                                      const BeamOptions&);

}  // namespace floe
