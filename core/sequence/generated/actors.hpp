#pragma once

#include <functional>

#include "core/sequence/generated/figure.hpp"
#include "core/sequence/generated/furniture.hpp"

namespace stillpoint::generated {

/// Adds someone or something to an instant; a function of time alone.
using Actor = std::function<void(double seconds, Instant& instant)>;

/// How the first, second, … person is dressed: plaid and shorts-sleeved, plain, striped.
[[nodiscard]] FigureLook appearance_of(int who, Furnisher& furnisher);

/// Someone on a chair who sways, turns the head towards `partner` and gestures now and then.
[[nodiscard]] Actor sitter(const FigureLook& look, const Vector2d& seat, double heading,
                           const Vector2d& partner, unsigned seed);
/// Two people who walk about the desk, pause, and sit down for a while.
[[nodiscard]] Actor walkers(const FigureLook& first, const FigureLook& second, double seconds, unsigned seed);
/// Someone at a desk who takes a mug from place to place and types in between.
[[nodiscard]] Actor desk_worker(const FigureLook& look, const Vector2d& seat, Furnisher& furnisher,
                                unsigned seed);
/// Someone who pushes a cart with a large box to and fro along the camera's optical axis.
[[nodiscard]] Actor cart_pusher(const FigureLook& look, Furnisher& furnisher, unsigned seed);
/// A mug pushed along the front of the table by a stick, with rests.
[[nodiscard]] Actor pushed_cup(Furnisher& furnisher, unsigned seed);

}  // namespace stillpoint::generated
