#include "sim_cuda/accuracy/record.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/finite_or_null.h"
#include "sim_cuda/scene/field_json.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

struct InvariantField {
  const char* name;
  double AccuracyInvariants::*value;
};
constexpr InvariantField quantities[] = {
    {"energy_drift", &AccuracyInvariants::energy_drift},
    {"energy_error", &AccuracyInvariants::energy_error},
    {"momentum_balance", &AccuracyInvariants::momentum_balance},
    {"angular_momentum_balance", &AccuracyInvariants::angular_momentum_balance},
    {"angular_momentum_error", &AccuracyInvariants::angular_momentum_error},
    {"penetration_max", &AccuracyInvariants::penetration_max},
    {"penetration_rms", &AccuracyInvariants::penetration_rms},
    {"penetration_over_radius", &AccuracyInvariants::penetration_over_radius},
    {"joint_error", &AccuracyInvariants::joint_error},
    {"joint_angle", &AccuracyInvariants::joint_angle},
    {"cone_violation", &AccuracyInvariants::cone_violation},
};

constexpr std::array<Named<AccuracyReference::Kind>, 2> kind_names{
    {{"hard_spheres", AccuracyReference::Kind::hard_spheres},
     {"converged_run", AccuracyReference::Kind::converged_run}}};

double number_of(const Json& json, double otherwise = not_known) {
  return json.is_null() ? otherwise : json.get<double>();
}

/// A member that files of older versions have under another name.
const Json& member(const Json& json, const char* name, const char* old_name) {
  return json.contains(name) ? json.at(name) : json.at(old_name);
}

template <class Table>
auto choice_of(const Json& json, const Table& table) {
  const auto name = json.get<std::string>();
  const auto value = value_of(table, name);
  if (!value) throw std::runtime_error(unknown_name("choice", name, names_in(table)));
  return *value;
}

Json json_of(const AccuracyPoint& p) {
  Json setting = Json::object();
  patch_of(p.setting).for_each_set([&](const auto& field, const auto& value) {
    setting[std::string(field.name)] = value_json(field, value);
  });
  setting["continuous_collision"] = p.setting.continuous_collision;
  Json json{{"series", p.series_name},
            {"name", p.name},
            {"setting", setting},
            {"measured", p.has_error()},
            {"error",
             {{"rms", finite_or_null(p.error)},
              {"low", finite_or_null(p.error_low)},
              {"high", finite_or_null(p.error_high)},
              {"worst", finite_or_null(p.error_worst)}}},
            {"ms_per_second",
             {{"median", finite_or_null(p.ms.median)},
              {"low", finite_or_null(p.ms.low)},
              {"high", finite_or_null(p.ms.high)},
              {"runs", p.ms_runs}}},
            {"on_front", p.on_front}};
  for (const InvariantField& each : quantities)
    json["invariants"][each.name] = finite_or_null(p.invariants.*each.value);
  json["distributions"] = {{"heights", finite_or_null(p.distributions.heights)},
                           {"speeds", finite_or_null(p.distributions.speeds)}};
  return json;
}

AccuracyPoint point_of(const Json& json) {
  AccuracyPoint p;
  p.series_name = member(json, "series", "family");
  p.name = json.at("name");
  const Json& s = json.at("setting");
  p.setting = {s.at("time_step"),
               s.at("substeps"),
               s.at("iterations"),
               choice_of(s.at("solver"), solver_names),
               choice_of(s.at("integrator"), integrator_names),
               choice_of(s.at("rotation_update"), rotation_update_names),
               choice_of(s.at("precision"), precision_names),
               s.at("continuous_collision")};
  const double otherwise = json.at("measured") ? std::numeric_limits<double>::infinity() : not_known;
  const Json& error = json.at("error");
  p.error = number_of(error.at("rms"), otherwise);
  p.error_low = number_of(error.at("low"), otherwise);
  p.error_high = number_of(error.at("high"), otherwise);
  p.error_worst = number_of(error.at("worst"), otherwise);
  const Json& ms = json.at("ms_per_second");
  p.ms = {number_of(ms.at("median")), number_of(ms.at("low")), number_of(ms.at("high"))};
  p.ms_runs = ms.at("runs").get<std::vector<double>>();
  for (const InvariantField& each : quantities)
    p.invariants.*each.value = number_of(json.at("invariants").at(each.name));
  p.distributions = {number_of(json.at("distributions").at("heights")),
                     number_of(json.at("distributions").at("speeds"))};
  p.on_front = json.at("on_front");
  return p;
}

}  // namespace

std::string write_record(const AccuracyRecord& record) {
  const AccuracyReference& r = record.reference;
  const Json head{{"suite", "accuracy"},
                  {"physics_version", record.physics_version},
                  {"scene", record.scene},
                  {"bodies", record.bodies},
                  {"executor", record.executor},
                  {"problem_hash", record.problem_hash},
                  {"rounds", record.rounds},
                  {"complete", record.complete},
                  {"reference",
                   {{"kind", name_of(kind_names, r.kind)},
                    {"description", r.description},
                    {"seconds", r.seconds},
                    {"horizon", r.horizon},
                    {"end", r.end},
                    {"error", finite_or_null(r.error)},
                    {"order", finite_or_null(r.order)},
                    {"lyapunov_rate", finite_or_null(r.lyapunov_rate)}}},
                  {"warnings", record.warnings}};
  std::string text = head.dump(2, ' ', false, Json::error_handler_t::replace);
  text.resize(text.size() - 2);  // removes the last line; each point then gets its own line
  text += ",\n  \"points\": [";
  for (const AccuracyPoint& point : record.points)
    text += (&point == record.points.data() ? "\n    " : ",\n    ") +
            json_of(point).dump(-1, ' ', false, Json::error_handler_t::replace);
  return text + "\n  ]\n}\n";
}

AccuracyRecord parse_record(const std::string& text, const std::string& name) {
  try {
    const Json json = Json::parse(text);
    if (json.at("suite") != "accuracy") throw std::runtime_error("suite must be accuracy");
    AccuracyRecord record;
    record.physics_version = json.value("physics_version", first_physics_version);
    json.at("scene").get_to(record.scene);
    json.at("executor").get_to(record.executor);
    member(json, "problem_hash", "subject").get_to(record.problem_hash);
    json.at("bodies").get_to(record.bodies);
    json.at("rounds").get_to(record.rounds);
    json.at("complete").get_to(record.complete);
    member(json, "warnings", "doubts").get_to(record.warnings);
    const Json& r = json.at("reference");
    AccuracyReference& reference = record.reference;
    reference.kind = choice_of(r.at("kind"), kind_names);
    r.at("description").get_to(reference.description);
    r.at("seconds").get_to(reference.seconds);
    r.at("horizon").get_to(reference.horizon);
    r.at("end").get_to(reference.end);
    reference.error = number_of(r.at("error"));
    reference.order = number_of(r.at("order"));
    reference.lyapunov_rate = number_of(member(r, "lyapunov_rate", "growth_rate"));
    for (const Json& point : json.at("points")) record.points.push_back(point_of(point));
    return record;
  } catch (const std::exception& error) {
    throw InputError(name + ": not an accuracy study: " + printable(error.what()));
  }
}

}  // namespace collidoscope
