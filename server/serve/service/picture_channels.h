#pragma once

#include <span>

#include "base/result.h"
#include "model/model_file.h"
#include "pick/front_surface.h"
#include "picture/channels.h"
#include "picture/picture.h"

namespace surfcast::service {

/// True if one of the channels is found by a search for the front surface.
bool needs_front_surface(const picture::ChannelSet& channels);

/// Fails if the model cannot have one of the channels.
Status check_channels(const picture::ChannelSet& channels, const model::ModelInfo& info);

/// The channels of a picture, in the order of picture::Channel. protocol/PROTOCOL.md has their names, units and frames,
/// and the values of the background. `front` is that of the same camera; empty if no channel needs it. The image holds
/// floats.
picture::Channels make_channels(const picture::ChannelSet& channels, const picture::Frame& frame,
                                std::span<const pick::FrontPixel> front);

}  // namespace surfcast::service
