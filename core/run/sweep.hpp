#pragma once

#include <atomic>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/parameter.hpp"
#include "core/run/ablation.hpp"

namespace stillpoint {

class FrameSource;
struct FrameResult;

// What one parameter does to a run: the same frames, once for each of several of its values.

/// The number a parameter stands at, 0 or 1 where it is off or on; nothing for one of words.
[[nodiscard]] std::optional<double> number_of(const Parameter& parameter);

/// "section.name=LOW:HIGH:STEPS", or without STEPS.
/// @throws InputError for a text that is none
[[nodiscard]] SweepRange sweep_range(const std::string& text);

/// The parameter's whole range, around its value in `config` where that is wide: a quarter to four times it.
/// @throws InputError for a parameter that there is not or that is no number
[[nodiscard]] SweepRange usual_sweep(const Config& config, const std::string& parameter);

/// The values, ascending, each once: evenly spaced, or by even factors where the range spans more than a
/// factor of 20; whole numbers for a parameter of whole numbers; on and off for one that is on or off.
/// @throws InputError for a parameter that there is not or is no number, and for values beyond its range
[[nodiscard]] std::vector<double> sweep_values(const Config& config, const SweepRange& range);

/// `config` with the parameter at a value.
[[nodiscard]] Config swept(const Config& config, const std::string& parameter, double value);

/// What a run reached at one value.
struct SweepPoint {
  double value = 0.0;
  AblationCell reached;
};

/// Runs the first `frames` frames (0 = all) at one value.
/// @param stop asked for while it runs: nothing is returned, for half a run is none to compare with
[[nodiscard]] std::optional<SweepPoint> sweep_point(
    const FrameSource& source, const Config& config, const std::string& parameter, double value, int frames,
    const std::atomic<bool>* stop, const std::function<void(const FrameResult&)>& on_frame = {});

/// The value of least RPE over 1 s among those that kept as many frames as any; nothing where none has one.
[[nodiscard]] std::optional<std::size_t> best_of(const std::vector<SweepPoint>& points);

/// What is to be known of the values of a range: that they are fewer than the steps asked for, or go up where
/// the range goes down. One sentence each.
/// @param values sweep_values of it
[[nodiscard]] std::vector<std::string> sweep_remarks(const Config& config, const SweepRange& range,
                                                     const std::vector<double>& values);

/// What is to be known beside these figures.
[[nodiscard]] std::vector<RunNote> notes_on(const SweepRange& range, const std::vector<SweepPoint>& points);

/// A row a value: RPE over 1 s, of how many pairs, and over a frame, ATE, IoU, frames with a pose, median
/// time.
[[nodiscard]] Table sweep_table(const SweepRange& range, const std::vector<SweepPoint>& points);
[[nodiscard]] nlohmann::ordered_json sweep_json(const std::string& sequence, const SweepRange& range,
                                                const std::vector<SweepPoint>& points);

}  // namespace stillpoint
