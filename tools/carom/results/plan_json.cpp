#include "results/plan_json.hpp"

namespace carom::tool {

namespace {
using Json = nlohmann::ordered_json;
}

Json plan_json(const Plan& plan) {
    Json json{{"solver", {{"name", plan.solver}, {"reason", plan.solver_reason}}},
              {"substeps", plan.substeps},
              {"iterations", plan.iterations},
              {"joints", plan.joints},
              {"precision", plan.precision},
              {"isa", plan.isa},
              {"threads", plan.threads},
              {"effects", Json::array()},
              {"stages", Json::array()},
              {"columns", Json::array()},
              {"bytes_per_body", plan.bytes_per_body},
              {"shapes", plan.shapes},
              {"bytes_per_shape", plan.bytes_per_shape},
              {"limits", plan.limits}};
    for (const EffectReport& effect : plan.effects)
        json["effects"].push_back({{"name", effect.name}, {"on", effect.on}, {"reason", effect.reason}});
    for (const StageReport& stage : plan.stages)
        json["stages"].push_back({{"name", stage.name},
                                  {"kernel", stage.kernel},
                                  {"reads", stage.reads},
                                  {"writes", stage.writes}});
    for (const ColumnReport& column : plan.columns)
        json["columns"].push_back(
            {{"name", column.name}, {"unit", column.unit}, {"bytes_per_body", column.bytes_per_body}});
    return json;
}

}  // namespace carom::tool
