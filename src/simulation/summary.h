/// \file
/// The end of a run: summary.json.
#pragma once

#include <string>

#include "floe/run/result.h"
#include "floe/scene.h"
#include "model/model.h"
#include "output/output.h"
#include "scene_model/scene_model.h"

namespace floe {

/// Checks that the scene is the test that it wants reported. If the command line may be the cause
/// that it is not, the report is dropped with a remark.
/// \throws InputError if the scene is not that test for another reason
void check_reports(Scene& scene);

/// summary.json of a run, and the lines that a user reads at its end.
struct Summary {
  std::string json, text;
};
template <class Space>
Summary summarise(const Scene& scene, const ModelChoice& choice, const Model<Space>& model,
                  const MeshReport& mesh, const RunResult& result, const Sample& first,
                  const Sample& last, double wall_seconds);

}  // namespace floe
