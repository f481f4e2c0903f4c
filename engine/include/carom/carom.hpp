#pragma once

/// Everything a program needs to embed Carom.

#include <carom/accuracy.hpp>
#include <carom/build_info.hpp>
#include <carom/effects.hpp>
#include <carom/errors.hpp>
#include <carom/events.hpp>
#include <carom/generators.hpp>
#include <carom/ids.hpp>
#include <carom/joints.hpp>
#include <carom/ledger.hpp>
#include <carom/materials.hpp>
#include <carom/profile.hpp>
#include <carom/scene.hpp>
#include <carom/shapes.hpp>
#include <carom/vec2.hpp>
#include <carom/version.hpp>
#include <carom/world.hpp>
