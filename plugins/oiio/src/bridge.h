// The C++ side of bridge.rs, which documents each function.
#pragma once

#include "rust/cxx.h"
#include <cstdint>

namespace spectra {

struct Plan;
struct Receiver;
struct Pixels;
struct Sink;

rust::String version();
rust::String endings();
bool reads_memory(rust::Str format);
void read(rust::Str format, rust::Str path, bool from_memory, rust::Slice<const std::uint8_t> bytes, Receiver &receiver);
void write(const Plan &plan, const Pixels &pixels, Sink &sink);
void make_texture(const Plan &plan, const Pixels &pixels, rust::Str path);

} // namespace spectra
