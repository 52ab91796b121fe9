#pragma once

namespace stillpoint {

/// Tells malloc how this program asks for memory. For main(), before threads begin, and for benchmarks that
/// stand for it; called again it changes nothing.
void tune_allocator();

}  // namespace stillpoint
