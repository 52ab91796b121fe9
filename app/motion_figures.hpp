#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/motion/paper/paper_trace.hpp"

namespace stillpoint {

/// The heading of motion.csv, without a line end.
[[nodiscard]] std::string motion_csv_heading();

/// A pair's row of motion.csv, figures of the last round, without a line end. What does not exist stays
/// empty.
/// @param reference,target how the frames are called: an index or a file name
[[nodiscard]] std::string motion_csv_row(const std::string& reference, const std::string& target,
                                         const PaperTrace& trace);

/// A pair's figures, every round's, with homographies and regions.
[[nodiscard]] nlohmann::json motion_json(const std::string& reference, const std::string& target,
                                         const PaperTrace& trace);

}  // namespace stillpoint
