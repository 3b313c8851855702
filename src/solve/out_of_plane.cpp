#include "solve/out_of_plane.h"

#include "floe/base/log.h"
#include "floe/base/petsc.h"
#include "solve/newton.h"

namespace floe {

std::int64_t unstable_modes(const Model<Planar>& model, const OutOfPlane& rest,
                            const State<Planar>& state) {
  constexpr std::uint8_t z_rx_ry = 0b011100;
  const Part& part = model.part();
  TangentOptions options;
  options.unknowns = z_rx_ry;
  Tangent<Spatial> tangent(part, rest.held, model.length_scale(), typical_stiffness(model),
                           options);
  {
    const Timed timed(Event::tangent);
    const State<Spatial> all = in_space(state, model.kinematics() == Kinematics::linear);
    tangent.begin();
    for (const auto& force : rest.forces) (void)force->add_tangent(all, tangent);
    tangent.end();
  }
  const Timed timed(Event::solve);
  Handle<KSP> ksp;
  check(KSPCreate(part.comm, ksp.put()));
  set_cholesky(ksp);
  check(KSPSetOperators(ksp, tangent.matrix(), tangent.matrix()));
  let_mumps_count(ksp);
  return negative_pivots(ksp);
}

}  // namespace floe
