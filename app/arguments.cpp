#include "app/arguments.hpp"

#include <cstdio>

#include "core/geometry/camera.hpp"
#include "core/sequence/generated/generated_sequence.hpp"

namespace stillpoint {

void ConfigArguments::add_to(CLI::App& command, bool with_method) {
  command.add_option("--config", preset, "A preset's name or a TOML file");
  command.add_option("--set", assignments, "One parameter, as section.name=value; may be given again");
  command.add_option("--threads", threads, "Worker threads; any number gives the same result")
      ->check(CLI::Range(1, 64));
  if (with_method)
    command.add_option("--method", method,
                       "What is removed: stillpoint, paper, none, or oracle (told the true masks)");
}

Config ConfigArguments::config() const {
  Config config = preset.empty() ? Config{} : load_config(preset);
  for (const std::string& assignment : assignments) set_parameter(config, assignment);
  if (!method.empty()) set_parameter(config, "run.method=" + method);
  if (threads > 0) config.run.threads = threads;
  return config;
}

void SequenceArguments::add_to(CLI::App& command, const char* frames_option) {
  command.add_option("--camera", camera, "A camera's name or a TOML file; otherwise the folder tells");
  command.add_option(frames_option, frames, "Only so many frames of the sequence, from the first on")
      ->check(CLI::Range(1, 10'000'000));
  command.add_option("--seed", seed, "Seed of a generated sequence")->check(CLI::Range(0, 1'000'000'000));
}

OpenOptions SequenceArguments::options(const Config& config) const {
  OpenOptions options;
  if (!camera.empty()) options.camera = camera_from_argument(camera);
  options.frames = frames;
  options.seed = static_cast<unsigned>(seed >= 0 ? seed : config.run.seed);
  return options;
}

std::unique_ptr<FrameSource> SequenceArguments::open(const std::string& where, const Config& config) const {
  auto source = open_sequence(where, options(config));
  for (const std::string& warning : source->warnings())
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  return source;
}

std::vector<std::string> expanded_sequences(const std::vector<std::string>& sequences) {
  std::vector<std::string> all;
  for (const std::string& sequence : sequences) {
    if (sequence == "generated:all")
      for (const std::string& kind : generated_kinds()) all.push_back("generated:" + kind);
    else
      all.push_back(sequence);
  }
  return all;
}

}  // namespace stillpoint
