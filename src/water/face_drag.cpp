#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "submersion/immersion.h"
#include "submersion/submersion.h"
#include "submersion/submersion_in_waves.h"
#include "submersion/waves.h"
#include "water/drag.h"
#include "water/face_wrench.h"
#include "water/shelter.h"

namespace floe {
namespace {

using Vec = Vec3<double>;
using Matrix = FaceWrench::Matrix;

/// A point of a face, from the body's centroid in world axes [m], and the height at it of a
/// function that is linear over the face.
struct Corner {
  Vec at;
  double height;
};

/// Keeps the part of a convex polygon where the height is positive.
void clip(const std::vector<Corner>& polygon, std::vector<Vec>& kept) {
  kept.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner& a = polygon[k];
    const Corner& b = polygon[k + 1 < polygon.size() ? k + 1 : 0];
    if (a.height > 0) kept.push_back(a.at);
    if ((a.height > 0) != (b.height > 0))
      kept.push_back(a.at + (a.height / (a.height - b.height)) * (b.at - a.at));
  }
}

/// Flow at a point of a face: weights of the three points of a triangle are equal (Strang & Fix
/// 1973: exact to the second degree).
struct Flow {
  Vec at, u;      ///< point from the centroid [m]; the water's velocity against it [m/s]
  double normal;  ///< u.n
  double area;    ///< weight [m^2]
  bool front;     ///< u.n < 0 on the whole triangle
};

/// The submerged parts that a force of this surface uses.
template <class Surface>
using SubmersionIn = std::conditional_t<Surface::moves, SubmersionInWaves, Submersion>;

/// Drag at the centroid and on faces of the owned bodies.
template <class Surface>
class FaceDrag final : public Force<Spatial>,
                       public HasTangent<Spatial>,
                       public Damps<Spatial>,
                       public DoesWork<Spatial>,
                       public LimitsStep<Spatial>,
                       public Commits<Spatial>,
                       public Persists,
                       public TakesBrokenPairs,
                       public DependsOnTime {
 public:
  FaceDrag(std::shared_ptr<SubmersionIn<Surface>> submersion, const DragOptions& options,
           Surface surface, bool leads)
      : part_(submersion->part()),
        surface_(std::move(surface)),
        submersion_(std::move(submersion)),
        immersion_(submersion_->immersion()),
        leads_(leads),
        normal_(face_normals(part_.shapes)),
        faces_(options.faces),
        linear_(options.linear),
        quadratic_(0.5 * options.density * options.coefficient),
        form_(0.5 * options.density * options.form),
        skin_(0.5 * options.density * options.skin),
        forces_(static_cast<std::size_t>(part_.owned)),
        moments_(forces_) {
    const Part& part = part_;
    std::size_t most = 0;
    for (std::size_t f = 0; f + 1 < part.shapes.corner_of.size(); ++f)
      most = std::max(
          most, static_cast<std::size_t>(part.shapes.corner_of[f + 1] - part.shapes.corner_of[f]));
    if (faces_) shelter_.emplace(part, options.shelter);
    for (auto* corners : {&corners_, &wet_corners_}) corners->reserve(most + 2);
    for (auto* points : {&wet_, &half_}) points->reserve(most + 3);
    for (std::int32_t body = 0; body < part.owned; ++body)
      area_per_volume_.push_back(
          immersion_.volume(body) > 0 ? immersion_.plan_area(body) / immersion_.volume(body) : 0);
    if (faces_ && submersion_->has_pace()) found_.resize(forces_.size());
  }

  std::string_view name() const override { return "drag"; }
  Roles<Spatial> roles() override {
    Roles<Spatial> roles{.tangent = this, .damping = this, .work = this, .step = this};
    if (faces_) roles.persists = this, roles.broken_pairs = this;
    if (faces_ && shelter_->renews()) roles.commits = this;
    if (leads_) roles.prepares = submersion_.get();
    if (leads_ && submersion_->has_pace()) roles.commits = this, roles.persists = this;
    if constexpr (Surface::moves) roles.time = this;
    return roles;
  }

  void add(const State<Spatial>& state, Wrenches<Spatial>& wrenches) override {
    const auto take = [&](std::size_t b, const Vec& force, const Vec& moment) {
      forces_[b] = force, moments_[b] = moment;
      floe::add(wrenches, b, force, moment);
    };
    if (submersion_->is_paced()) {
      if (leads_) submersion_->find_all_at_pace(state);
      evaluate_at_pace(state, take);
    } else {
      evaluate(state, take);
    }
    powers_with(state, std::span(&power_, 1));
  }
  /// The derivative to places is small against that of buoyancy, and left out.
  bool add_tangent(const State<Spatial>&, Tangent<Spatial>&) const override { return false; }
  void add_damping(const State<Spatial>& state, Tangent<Spatial>& tangent) const override {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      Tangent<Spatial>::Block c{};
      each_slope(state, body, [&](const Vec& at, const Matrix& d) {
        // v + w x r = J (v, w): J = (1, -[r]x); C = J^T D J.
        const std::array<Vec, 3> arm{Vec{0, at.z, -at.y}, Vec{-at.z, 0, at.x}, Vec{at.y, -at.x, 0}};
        const auto column = [&](std::size_t k, std::size_t row) {
          return k < 3 ? (k == row ? 1.0 : 0.0) : arm[row][k - 3];
        };
        for (std::size_t i = 0; i < 6; ++i)
          for (std::size_t k = 0; k < 6; ++k)
            for (std::size_t r = 0; r < 3; ++r)
              for (std::size_t s = 0; s < 3; ++s)
                c[i * 6 + k] += column(i, r) * d[r][s] * column(k, s);
      });
      tangent.add_body(body, c);
    }
  }
  void add_losses(const State<Spatial>& state, Wrenches<Spatial>& wrenches) const override {
    evaluate(state, [&](std::size_t b, const Vec& force, const Vec& moment) {
      floe::add(wrenches, b, force, moment);
    });
  }

  double stiffness_bound(std::int32_t) const override { return 0; }
  /// Bound of the derivative of the wrench to the velocities, over mass and moments of inertia.
  std::optional<double> rate_estimate(const State<Spatial>& state) const override {
    double fastest = 0;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const Point3& inertia = item(part_.bodies.inertia, body);
      const double mass = item(part_.bodies.mass, body),
                   least = std::min({inertia.x, inertia.y, inertia.z});
      double rate = 0;
      each_slope(state, body, [&](const Vec& at, const Matrix& d) {
        rate += (d[0].x + d[1].y + d[2].z) * (1 / mass + dot(at, at) / least);
      });
      fastest = std::max(fastest, rate);
    }
    return fastest;
  }

  void powers(std::span<double> out) const override { out.front() = power_; }
  LaterPowers later_powers() const override { return LaterPowers::at_once; }
  void powers_with(const State<Spatial>& state, std::span<double> out) const override {
    double power = 0;
    for (std::size_t b = 0; b < forces_.size(); ++b)
      power += dot(forces_[b], velocity(state, b)) + dot(moments_[b], angular_velocity(state, b));
    out.front() = power;
  }
  void report(const State<Spatial>&, std::span<const double> works,
              Columns& columns) const override {
    columns.add("energy_drag", 0.0 - works.front());
  }

  void commit(const State<Spatial>& state, double dt) override {
    if (leads_) submersion_->commit(state, dt);
    if (faces_ && shelter_->renews()) shelter_->after_step(state);
  }
  void persist(Archive& archive) override {
    if (leads_ && submersion_->has_pace()) submersion_->persist(archive);
    if (!faces_) return;
    shelter_->persist(archive);
    if (submersion_->has_pace()) persist_found(archive);
  }
  void release(std::span<const std::array<std::int32_t, 2>> pairs) override {
    shelter_->release(pairs);
  }
  std::vector<double> changes(double end) const override { return {end}; }

 private:
  /// Calls take(b, force, moment) for each owned body.
  [[gnu::flatten]] void evaluate(const State<Spatial>& state, auto&& take) const {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      Vec force{0, 0, 0}, moment{0, 0, 0};
      each_flow(state, body, [&](const Flow& flow, const Vec& n) {
        const Vec f = force_of(flow, n);
        force = force + f;
        moment = moment + cross(flow.at, f);
      });
      const auto [wet, u] = at_centroid(state, body);
      if (wet > 0) force = force + ((linear_ + quadratic_ * length(u)) * wet) * u;
      take(static_cast<std::size_t>(body), force, moment);
    }
  }
  /// The same, where drag on faces is found only for bodies whose submerged part is new.
  void evaluate_at_pace(const State<Spatial>& state, auto&& take) {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      Vec force{0, 0, 0}, moment{0, 0, 0};
      if (faces_) {
        if (submersion_->is_new(b)) find(state, body);
        std::tie(force, moment) =
            found_[b].at(water_at(state, b) - velocity(state, b), angular_velocity(state, b));
      }
      const auto [wet, u] = at_centroid(state, body);
      if (wet > 0) force = force + ((linear_ + quadratic_ * length(u)) * wet) * u;
      take(b, force, moment);
    }
  }
  /// Finds the drag on a body's faces, with its derivatives.
  void find(const State<Spatial>& state, std::int32_t body) {
    const auto b = static_cast<std::size_t>(body);
    FaceWrench found;
    found.against = water_at(state, b) - velocity(state, b);
    found.spin = angular_velocity(state, b);
    each_flow(state, body, [&](const Flow& flow, const Vec& n) {
      const Vec f = force_of(flow, n);
      found.force = found.force + f;
      found.moment = found.moment + cross(flow.at, f);
      found.add_slope(flow.at, slope_of(flow, n));
    });
    found_[b] = found;
  }
  void persist_found(Archive& archive) {
    std::vector<std::int32_t> bodies;
    std::vector<double> rows;
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      bodies.push_back(body);
      for (const double* number : item(found_, body).all()) rows.push_back(*number);
    }
    archive.rows("face_drag", bodies, rows, static_cast<int>(FaceWrench::numbers));
    if (!archive.loading()) return;
    const double* row = rows.data();
    for (FaceWrench& found : found_)
      for (double* number : found.all()) *number = *row++;
  }

  Vec force_of(const Flow& flow, const Vec& n) const {
    const Vec along = flow.u - flow.normal * n;
    Vec f = (skin_ * length(along) * flow.area) * along;
    if (flow.front) f = f - (form_ * flow.normal * flow.normal * flow.area) * n;
    return f;
  }
  static void add_rank_one(Matrix& d, double size, const Vec& a) {
    for (std::size_t r = 0; r < 3; ++r) d[r] = d[r] + (size * a[r]) * a;
  }
  static void add_unit(Matrix& d, double size) {
    for (std::size_t r = 0; r < 3; ++r) d[r][r] += size;
  }
  /// Derivative of force_of() to the velocity of the body at the point, times -1.
  Matrix slope_of(const Flow& flow, const Vec& n) const {
    Matrix d{};
    if (flow.front) add_rank_one(d, -2 * form_ * flow.normal * flow.area, n);
    const Vec along = flow.u - flow.normal * n;
    const double speed = length(along), weight = skin_ * flow.area;
    add_unit(d, weight * speed);
    add_rank_one(d, -weight * speed, n);
    if (speed > 0) add_rank_one(d, weight / speed, along);
    return d;
  }

  /// Calls take(r, D) with the derivative D of the force at r to the velocity of the body there,
  /// times -1; D is symmetric and positive.
  void each_slope(const State<Spatial>& state, std::int32_t body, auto&& take) const {
    each_flow(state, body,
              [&](const Flow& flow, const Vec& n) { take(flow.at, slope_of(flow, n)); });
    const auto [wet, u] = at_centroid(state, body);
    if (!(wet > 0)) return;
    Matrix d{};
    const double speed = length(u);
    add_unit(d, wet * (linear_ + quadratic_ * speed));
    if (speed > 0) add_rank_one(d, wet * quadratic_ / speed, u);
    take(Vec{0, 0, 0}, d);
  }

  SurfacePlane plane_at(const State<Spatial>& state, std::size_t b) const {
    if constexpr (Surface::moves)
      if (submersion_->knows_volumes()) return submersion_->plane(b);
    return surface_.plane(b, immersion_.centroid(state, static_cast<std::int32_t>(b)), state.time);
  }
  Vec water_at(const State<Spatial>& state, std::size_t b) const {
    if constexpr (Surface::moves)
      if (submersion_->knows_volumes()) return submersion_->water(b);
    return surface_.velocity(b, immersion_.centroid(state, static_cast<std::int32_t>(b)),
                             state.time);
  }
  double volume_at(const State<Spatial>& state, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    if (submersion_->knows_volumes()) return submersion_->volume_of(b);
    return Surface::moves ? immersion_.below(state, body, plane_at(state, b)).volume
                          : immersion_.of(state, body).volume;
  }

  /// Wet plan area [m^2], if the scene has drag at centroids, and the velocity of the water against
  /// the centroid [m/s].
  std::pair<double, Vec> at_centroid(const State<Spatial>& state, std::int32_t body) const {
    if (linear_ == 0 && quadratic_ == 0) return {0, {0, 0, 0}};
    const auto b = static_cast<std::size_t>(body);
    return {area_per_volume_[b] * volume_at(state, body), water_at(state, b) - velocity(state, b)};
  }

  /// Calls take(flow, n) at the points of the quadrature of all wet faces without shelter.
  void each_flow(const State<Spatial>& state, std::int32_t body, auto&& take) const {
    if (!faces_) return;
    const auto b = static_cast<std::size_t>(body);
    const Shapes& shapes = part_.shapes;
    const auto [w, x, y, z] = part_.bodies.orientation[b];
    const Triad<double> axes =
        triad(product(of_unit_length(rotation(state, b)), Quat<double>{w, x, y, z}));
    const Vec at = immersion_.centroid(state, body);
    const SurfacePlane plane = plane_at(state, b);
    const Vec against = water_at(state, b) - velocity(state, b), spin = angular_velocity(state, b);
    for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1]; ++f) {
      if ((*shelter_)(f)) continue;
      corners_.clear();
      bool any = false;
      for (std::int32_t c = item(shapes.corner_of, f); c < item(shapes.corner_of, f + 1); ++c) {
        const Vec r = axes.to_world(item(shapes.vertices, item(shapes.corners, c)));
        const double depth = plane.level + plane.slope_x * r.x + plane.slope_y * r.y - (at.z + r.z);
        any = any || depth > 0;
        corners_.push_back({r, depth});
      }
      if (!any) continue;
      clip(corners_, wet_);
      const Vec n = axes.to_world(item(normal_, f));
      const auto flow_at = [&](const Vec& r) { return against - cross(spin, r); };
      wet_corners_.clear();
      bool front = false, back = false;
      for (const Vec& r : wet_) {
        const double normal = dot(flow_at(r), n);
        (normal < 0 ? front : back) = true;
        wet_corners_.push_back({r, -normal});
      }
      const auto triangles = [&](const std::vector<Vec>& polygon, bool is_front) {
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
          const std::array<Vec, 3> p{polygon[0], polygon[k], polygon[k + 1]};
          const double area = 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
          const Vec sum = p[0] + p[1] + p[2];
          for (const Vec& corner : p) {
            const Vec r = (1.0 / 6) * sum + 0.5 * corner, u = flow_at(r);
            take(Flow{r, u, dot(u, n), area / 3, is_front}, n);
          }
        }
      };
      if (!front || !back) {
        triangles(wet_, front);
        continue;
      }
      clip(wet_corners_, half_);
      triangles(half_, true);
      for (Corner& c : wet_corners_) c.height = -c.height;
      clip(wet_corners_, half_);
      triangles(half_, false);
    }
  }

  const Part& part_;
  Surface surface_;
  std::shared_ptr<SubmersionIn<Surface>> submersion_;
  const Immersion& immersion_;
  bool leads_;                      ///< calls the submerged parts in each step
  std::optional<Shelter> shelter_;  ///< of faces
  std::vector<Vec> normal_;         ///< per face of the owned bodies, in the body's axes
  bool faces_;
  double linear_, quadratic_;            ///< at centroids [N s/m^3, N s^2/m^4]
  double form_, skin_;                   ///< rho_w C_d/2, rho_w C_s/2 [kg/m^3]
  std::vector<double> area_per_volume_;  ///< plan area over volume of each body [1/m]
  std::vector<Vec> forces_, moments_;    ///< of the last evaluation [N, N m]
  double power_ = 0;                     ///< of the last evaluation [W]
  std::vector<FaceWrench> found_;        ///< per body, with a pace
  // Work space: corners of a face; its wet part; one side of u.n = 0 of that.
  mutable std::vector<Corner> corners_, wet_corners_;
  mutable std::vector<Vec> wet_, half_;
};

}  // namespace

std::unique_ptr<Force<Spatial>> make_face_drag(const Part& part, const DragOptions& options,
                                               double gravity, const WaveOptions& waves) {
  require_shapes(part, "drag");
  if (waves.any())
    return make_face_drag(std::make_shared<SubmersionInWaves>(
                              part, Waves(part, gravity, waves, options.water()), 1, false),
                          options, false);
  return make_face_drag(std::make_shared<Submersion>(part, 1, false, options.level_table), options,
                        false);
}
std::unique_ptr<Force<Spatial>> make_face_drag(std::shared_ptr<Submersion> submersion,
                                               const DragOptions& options, bool leads) {
  return std::make_unique<FaceDrag<StillWater>>(std::move(submersion), options,
                                                StillWater{options.water()}, leads);
}
std::unique_ptr<Force<Spatial>> make_face_drag(std::shared_ptr<SubmersionInWaves> submersion,
                                               const DragOptions& options, bool leads) {
  const Waves waves = submersion->waves();
  return std::make_unique<FaceDrag<Waves>>(std::move(submersion), options, waves, leads);
}

}  // namespace floe
