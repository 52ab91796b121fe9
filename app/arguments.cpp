#include "app/arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/check/time_calibration.hpp"
#include "core/error.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/masks/outside_masks.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/method_needs.hpp"
#include "core/run/records_file.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/text_file.hpp"

namespace stillpoint {

void ConfigArguments::add_to(CLI::App& command, bool with_method) {
  command.add_option("--config", preset, "A preset's name or a TOML file");
  command.add_option("--set", assignments, "One parameter, as section.name=value; may be given again");
  command.add_option("--threads", threads, "Worker threads; any number gives the same result")
      ->check(CLI::Range(1, 64));
  if (!with_method) return;
  command.add_option("--masks", masks,
                     "Masks made elsewhere, folders or lists of images parted by commas: alone, or with "
                     "--method together with that method's own");
  command.add_option("--method", method,
                     fmt::format("Which method judges what is dynamic: {}", fmt::join(method_names(), ", ")));
  command.add_option(
      "--odometry", odometry,
      fmt::format("Which engine tells where the camera is: {}", fmt::join(engine_names(), ", ")));
}

namespace {

/// Masks by absolute paths, so that a run's config finds them from anywhere.
std::string absolute_sources(const std::string& sources) {
  std::vector<std::string> all;
  for (const std::string& source : split_masks(sources))
    all.push_back(std::filesystem::absolute(source).lexically_normal().string());
  return fmt::format("{}", fmt::join(all, ","));
}

}  // namespace

Config ConfigArguments::config() const {
  Config config = preset.empty() ? Config{} : load_config(preset);
  for (const std::string& assignment : assignments) set_parameter(config, assignment);
  if (!masks.empty()) {
    config.of<MasksConfig>().sources = absolute_sources(masks);
    if (method.empty() && preset.empty()) config.run.method = outside_masks_method().name;
  }
  if (!method.empty()) set_parameter(config, "run.method=" + method);
  if (!odometry.empty()) set_parameter(config, "run.odometry=" + odometry);
  if (threads > 0) config.run.threads = threads;
  const OutsideMasks outside(config);
  if (!outside.problem().empty()) throw InputError(outside.problem());
  for (const std::string& warning : outside.warnings())
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  return config;
}

void throw_usage(const std::string& what) { throw CLI::ValidationError(what); }

void throw_if_among_data(const std::string& out, const std::vector<std::string>& sequences) {
  std::error_code none;
  for (const std::string& sequence : sequences)
    if (std::filesystem::equivalent(out, sequence, none) && !is_run_folder(sequence))
      throw InputError(
          fmt::format("--out {}: is the sequence itself; results need a folder of their own", out));
}

void throw_if_among_results(const std::string& out) {
  if (is_run_folder(out))
    throw InputError(fmt::format("{}: holds a finished run; a sequence needs a folder of its own", out));
}

void throw_if_no_pair(const Config& config) {
  if (const std::string why = why_no_pair(config); !why.empty()) throw InputError(why);
  if (const std::string why = why_no_outside_masks(config); !why.empty()) throw InputError(why);
}

CLI::Validator number_between(double least, double most) {
  const std::string range = fmt::format("FLOAT in [{:g} - {:g}]", least, most);
  return {[least, most](std::string& text) {
            const auto value = parse_number(text);
            return value && *value >= least && *value <= most
                       ? std::string()
                       : fmt::format("Value {} not in range {:g} to {:g}", text, least, most);
          },
          range};
}

void SequenceArguments::add_to(CLI::App& command, const char* frames_option) {
  command.add_option(
      "--camera", camera,
      "A camera's name, or a file: TOML, or YAML of ORB-SLAM, Kalibr or EuRoC; otherwise the folder tells");
  command.add_option(frames_option, frames, "Only so many frames of the sequence, from the first on")
      ->check(CLI::Range(1, 10'000'000));
  command.add_option("--seed", seed, "Seed of a generated sequence")->check(CLI::Range(0, 1'000'000'000));
  command
      .add_option("--frame-rate", frame_rate, "Of a folder whose stamps are frame numbers [Hz]; otherwise 30")
      ->check(number_between(0.01, 1000.0));
  command
      .add_option("--depth-scale", depth_scale,
                  "Depth image units a metre, whatever the camera says: 1000 = millimetres")
      ->check(number_between(1.0, 1e6));
  command.add_option("--depth-offset", depth_offset_s, "Added to the stamps of depth images [s]")
      ->check(number_between(-1e10, 1e10));
  command.add_option(
      "--truth", truth,
      "What a folder's ground truth means by a pose: as-written, inverse, w-first, mirrored-x, "
      "mirrored-y (ICL-NUIM), mirrored-z, opengl (y up, z backward), bonn");
  command.add_flag("--invert-masks", inverted_masks, "White in a folder's masks is what stands still");
  command.add_flag(
      "--calibrate-time", calibrate_time,
      "Measure the camera's readouts and depth's delay by the sequence's own frames first, and go by "
      "them (`stillpoint check` prints them)");
  command.add_flag(
      "--fix", fix,
      "Question the sequence first, as `stillpoint check` does, and read it otherwise where that "
      "is certain to be right; what is done is told");
  command.add_option(
      "--topics", topics,
      "Of a bag: colour=TOPIC,depth=TOPIC,info=TOPIC,truth=TOPIC, any of them, none but colour "
      "where it is `none`; `stillpoint check` lists what it holds");
  command.add_option(
      "--stereo", stereo,
      "Of stereo pairs, how they are matched: size=full|half, disparities=N (px, a multiple of 16), "
      "check=on|off (left-right), parted by commas");
}

bool SequenceArguments::given() const {
  return !camera.empty() || frames > 0 || seed >= 0 || frame_rate > 0 || depth_scale > 0 ||
         depth_offset_s != 0 || !truth.empty() || inverted_masks || calibrate_time || fix ||
         !topics.empty() || !stereo.empty();
}

namespace {

/// Calls `visit(name, field)` for what says how a sequence is read.
template <typename Arguments, typename Visit>
void visit_reading(Arguments& arguments, Visit visit) {
  visit("camera", arguments.camera);
  visit("frames", arguments.frames);
  visit("seed", arguments.seed);
  visit("frame_rate", arguments.frame_rate);
  visit("depth_scale", arguments.depth_scale);
  visit("depth_offset", arguments.depth_offset_s);
  visit("truth", arguments.truth);
  visit("invert_masks", arguments.inverted_masks);
  visit("calibrate_time", arguments.calibrate_time);
  visit("topics", arguments.topics);
  visit("stereo", arguments.stereo);
}

/// The switch of a field of the reading: "depth-scale".
std::string switch_named(std::string field) {
  std::replace(field.begin(), field.end(), '_', '-');
  return field;
}

void read_word(const std::string& word, std::string& value) { value = word; }
void read_word(const std::string& word, bool& value) { value = word == "true"; }
template <typename Number>
void read_word(const std::string& word, Number& value) {
  (void)std::from_chars(word.data(), word.data() + word.size(), value);
}

}  // namespace

std::vector<std::string> SequenceArguments::words() const {
  SequenceArguments kept = *this, plain;
  std::error_code none;
  if (std::filesystem::is_regular_file(camera, none))
    kept.camera = std::filesystem::absolute(camera).string();
  std::vector<std::string> defaults, words;
  visit_reading(plain, [&](const char*, const auto& value) { defaults.push_back(fmt::format("{}", value)); });
  std::size_t at = 0;
  visit_reading(kept, [&](const char* name, const auto& value) {
    const std::string text = fmt::format("{}", value);
    if (text != defaults[at++]) words.push_back(fmt::format("{}={}", name, text));
  });
  return words;
}

SequenceArguments SequenceArguments::from_words(const std::vector<std::string>& words) {
  SequenceArguments arguments;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) continue;
    visit_reading(arguments, [&](const std::string& name, auto& value) {
      if (word.compare(0, equals, name) == 0 && name.size() == equals)
        read_word(word.substr(equals + 1), value);
    });
  }
  return arguments;
}

OpenOptions SequenceArguments::options(const Config& config) const {
  OpenOptions options;
  if (!camera.empty()) options.camera = camera_from_argument(camera);
  options.frames = frames;
  options.seed = static_cast<unsigned>(seed >= 0 ? seed : config.run.seed);
  if (frame_rate > 0) options.frame_rate = frame_rate;
  if (depth_scale > 0) options.depth_scale = depth_scale;
  options.depth_offset_s = depth_offset_s;
  options.truth = convention_argument("--truth", truth);
  options.inverted_masks = inverted_masks;
  options.topics = topics;
  options.stereo = stereo_options_from(stereo, "--stereo");
  options.progress = opening_progress();
  return options;
}

SequenceArguments SequenceArguments::fixed(const std::string& where, const Config& config) const {
  std::error_code none;
  if (is_run_folder(where) && std::filesystem::exists(std::filesystem::path(where) / kRecordsName, none))
    throw InputError(
        fmt::format("{}: is a finished run, and a sequence is wanted here; `stillpoint view`, "
                    "`snapshot`, `report`, `figures` and `export --to` take runs",
                    where));
  SequenceArguments reading = *this;
  if (!std::exchange(reading.fix, false)) return reading;
  std::vector<std::string> given;  // switches, which stand
  for (const std::string& word : reading.words())
    given.push_back(switch_named(word.substr(0, word.find('='))));
  const StopBySignal stop;
  for (;;) {
    const auto source = open_sequence(where, reading.options(config));
    const auto remedy = first_remedy(check_sequence(*source, stop.token()).findings, given);
    throw_if_interrupted();
    if (!remedy) return reading;
    std::fprintf(stderr, "stillpoint: fixed by %s: %s\n", remedy->first.text().c_str(),
                 remedy->second.sentence.c_str());
    reading.set(remedy->first);
    given.push_back(remedy->first.name);
  }
}

void SequenceArguments::tell_what_is_of_no_use(const std::string& where, const FrameSource& source) const {
  const auto tell = [&where](const std::string& option, const char* what) {
    warn_once(fmt::format("{}: {} is of no use here: it goes with {}", where, option, what));
  };
  if (!stereo.empty() && !source.camera().is_stereo()) tell("--stereo", "stereo pairs");
  if (!where.starts_with("generated:")) {
    const auto lacks = [&source](FramePart part, bool there) {
      return !there && source.why_not(part).empty();
    };
    if (seed >= 0) tell("--seed", "generated sequences");
    if (inverted_masks && lacks(FramePart::masks, source.has_masks())) tell("--invert-masks", "true masks");
    if (!truth.empty() && lacks(FramePart::truth, !source.ground_truth().empty()))
      tell("--truth", "ground truth");
    if (frame_rate > 0 && !source.contents().empty())
      tell("--frame-rate", "frame numbers in place of stamps");
    if (depth_scale > 0 && source.camera().is_stereo()) tell("--depth-scale", "depth images");
    return;
  }
  for (const std::string& word : words()) {
    const std::string option = switch_named(word.substr(0, word.find('=')));
    for (const char* recorded :
         {"frame-rate", "depth-scale", "depth-offset", "truth", "invert-masks", "topics"})
      if (option == recorded) tell("--" + option, "recorded sequences");
  }
}

void SequenceArguments::set(const Remedy& remedy) {
  visit_reading(*this, [&remedy](const char* name, auto& value) {
    if (switch_named(name) == remedy.name) read_word(remedy.value.empty() ? "true" : remedy.value, value);
  });
}

std::unique_ptr<FrameSource> SequenceArguments::open(const std::string& where, const Config& config,
                                                     SequenceNeeds needs) const {
  const SequenceArguments reading = fixed(where, config);
  if (fix) return reading.open(where, config, needs);
  auto source = open_sequence(where, options(config));
  if (needs.depth && !source->has_depth()) {
    const std::string why = source->why_not(FramePart::depth);
    throw InputError(why.empty()
                         ? fmt::format("{}: has colour frames only, and odometry needs depth; `stillpoint "
                                       "motion` works without",
                                       where)
                         : fmt::format("{}: its depth is of no use: {}", where, why));
  }
  if (needs.oracle)
    if (const std::string why = why_no_true_masks(*source, where); !why.empty()) throw InputError(why);
  if (const std::string why = why_no_mask_fits(config, *source); !why.empty()) throw InputError(why);
  tell_what_is_of_no_use(where, *source);
  for (const std::string& warning : source->warnings())
    std::fprintf(stderr, "stillpoint: warning: %s\n", warning.c_str());
  if (needs.questioned)
    for (const Finding& finding : look_over(*source))
      std::fprintf(stderr, "stillpoint: warning: %s: %s\n", where.c_str(), finding.sentence.c_str());
  if (!calibrate_time) return source;
  const TimeCalibration times = stillpoint::calibrate_time(*source, config, {.stop = &stop_requested()});
  throw_if_interrupted();
  for (const std::string& line : to_lines(times, source->camera()))
    std::fprintf(stderr, "stillpoint: time: %s\n", line.c_str());
  if (!times.told()) return source;
  OpenOptions as_measured = options(config);
  as_measured.camera = times.applied_to(source->camera());
  return open_sequence(where, as_measured);
}

PoseConvention convention_argument(const char* option, const std::string& name) {
  if (name.empty()) return PoseConvention::as_written;
  if (const auto convention = convention_by_name(name)) return *convention;
  std::string names(to_string(PoseConvention::as_written));
  for (const PoseConvention other : other_conventions()) names += fmt::format(", {}", to_string(other));
  throw InputError(fmt::format("{} {}: expected one of {}", option, name, names));
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
