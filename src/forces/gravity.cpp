#include "forces/gravity.h"

#include "floe/base/item.h"

namespace floe {
namespace {

class Gravity final : public Force<Spatial>, public OnDevice {
 public:
  Gravity(const Part& part, double acceleration) : part_(part), g_(acceleration) {}

  std::string_view name() const override { return "gravity"; }
  Roles<Spatial> roles() override { return {.device = this}; }

  void describe(DeviceModel& model) override {
    model.weights.resize(static_cast<std::size_t>(part_.owned));
    for (std::int32_t b = 0; b < part_.owned; ++b)
      item(model.weights, b) = is_dry(part_.bodies, b) ? 0.0 : item(part_.bodies.mass, b) * g_;
  }
  void add(const State<Spatial>&, Wrenches<Spatial>& wrenches) override {
    const bool all = part_.bodies.dry.empty();
    for (std::int32_t b = 0; b < part_.owned; ++b) {
      if (all || !is_dry(part_.bodies, b))
        wrenches.of(static_cast<std::size_t>(b))[2] -= item(part_.bodies.mass, b) * g_;
    }
  }
  /// Reports the potential m g u_z, 0 at rest.
  void report(const State<Spatial>& state, std::span<const double>,
              Columns& columns) const override {
    double energy = 0;
    for (std::int32_t b = 0; b < part_.owned; ++b) {
      if (is_dry(part_.bodies, b)) continue;
      energy +=
          item(part_.bodies.mass, b) * g_ * displacement(state, static_cast<std::size_t>(b)).z;
    }
    columns.add("energy_gravity", energy);
  }

 private:
  const Part& part_;
  double g_;
};

}  // namespace

template <>
std::unique_ptr<Force<Spatial>> make_gravity<Spatial>(const Part& part, double acceleration) {
  return std::make_unique<Gravity>(part, acceleration);
}

}  // namespace floe
