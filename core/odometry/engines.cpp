#include "core/odometry/engines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/odometry_engine.hpp"

// One line an engine: NAME is defined as `EngineInfo NAME_engine()` in the engine's own file.
#define STILLPOINT_ENGINES(ENGINE) \
  ENGINE(features)                 \
  ENGINE(bamvo)                    \
  ENGINE(dso)                      \
  ENGINE(ptam)

namespace stillpoint {

#define DECLARE_ENGINE(name) EngineInfo name##_engine();
STILLPOINT_ENGINES(DECLARE_ENGINE)
#undef DECLARE_ENGINE

const std::vector<EngineInfo>& engines() {
#define LIST_ENGINE(name) name##_engine(),
  static const std::vector<EngineInfo> all = {STILLPOINT_ENGINES(LIST_ENGINE)};
#undef LIST_ENGINE
  return all;
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const EngineInfo& engine : engines()) names.push_back(engine.name);
  return names;
}

const EngineInfo& engine_named(const std::string& name) {
  for (const EngineInfo& engine : engines())
    if (engine.name == name) return engine;
  throw InputError(fmt::format("there is no odometry engine '{}'; the engines are: {}", name,
                               fmt::join(engine_names(), ", ")));
}

const EngineInfo& engine_of(const Config& config) { return engine_named(config.run.odometry); }

std::string why_no_pair(const Config& config) {
  const MethodInfo& method = method_of(config);
  const EngineInfo& engine = engine_of(config);
  if (method.needs.matches && !engine.offers_matches)
    return fmt::format("method {} judges matched points, and odometry {} has none", method.name, engine.name);
  return {};
}

std::string run_label(const Config& config) {
  return config.run.odometry == kDefaultEngine ? config.run.method
                                               : config.run.odometry + "/" + config.run.method;
}

std::string run_words(const Config& config) {
  const std::string method = "method " + config.run.method;
  return config.run.odometry == kDefaultEngine ? method : "odometry " + config.run.odometry + ", " + method;
}

std::unique_ptr<OdometryEngine> make_odometry_engine(const Camera& camera, const Config& config) {
  if (const std::string why = why_no_pair(config); !why.empty()) throw InputError(why);
  return engine_of(config).make(camera, config);
}

}  // namespace stillpoint
