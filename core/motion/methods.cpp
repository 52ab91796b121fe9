#include "core/motion/methods.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.hpp"

// One line a method: NAME is defined as `MethodInfo NAME_method()` in the method's own file.
#define STILLPOINT_METHODS(METHOD) \
  METHOD(stillpoint)               \
  METHOD(paper)                    \
  METHOD(none)                     \
  METHOD(oracle)                   \
  METHOD(epipolar)                 \
  METHOD(yi2013)                   \
  METHOD(alcantarilla2012)         \
  METHOD(gao2019)                  \
  METHOD(lin2017)                  \
  METHOD(dai2020)                  \
  METHOD(peng2017)                 \
  METHOD(wang2014)                 \
  METHOD(masks)

namespace stillpoint {

#define DECLARE_METHOD(name) MethodInfo name##_method();
STILLPOINT_METHODS(DECLARE_METHOD)
#undef DECLARE_METHOD

namespace {

std::deque<MethodInfo>& registry() {
#define LIST_METHOD(name) name##_method(),
  static std::deque<MethodInfo> all = {STILLPOINT_METHODS(LIST_METHOD)};
#undef LIST_METHOD
  return all;
}

}  // namespace

const std::deque<MethodInfo>& methods() { return registry(); }

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodInfo& method : methods()) names.push_back(method.name);
  return names;
}

const MethodInfo& method_named(const std::string& name) {
  for (const MethodInfo& method : methods())
    if (method.name == name) return method;
  throw InputError(
      fmt::format("there is no method '{}'; the methods are: {}", name, fmt::join(method_names(), ", ")));
}

const MethodInfo& method_of(const Config& config) { return method_named(config.run.method); }

std::vector<std::string> usual_methods() {
  std::vector<std::string> names{baseline_method().name};
  for (const MethodInfo& method : methods())
    if (method.usual && !method.baseline) names.push_back(method.name);
  return names;
}

const MethodInfo& baseline_method() {
  return *std::find_if(methods().begin(), methods().end(), [](const MethodInfo& m) { return m.baseline; });
}

const MethodInfo& outside_masks_method() {
  return *std::find_if(methods().begin(), methods().end(),
                       [](const MethodInfo& m) { return m.needs.outside_masks; });
}

void register_method(MethodInfo method) {
  const std::vector<std::string> names = method_names();
  if (std::find(names.begin(), names.end(), method.name) != names.end())
    throw InputError(fmt::format("there is a method '{}' already", method.name));
  for (const MethodInfo& other : methods())
    for (const FigureInfo& theirs : other.figures)
      for (const FigureInfo& figure : method.figures)
        if (figure.name == theirs.name)
          throw InputError(
              fmt::format("methods {} and {} both have a figure '{}'", method.name, other.name, figure.name));
  registry().push_back(std::move(method));
}

}  // namespace stillpoint
