// Calls OpenImageIO for bridge.rs. Every failure leaves as a std::exception, which cxx turns into an `Err`.

#include "spectra-plugin-oiio/src/bridge.h"
#include "spectra-plugin-oiio/src/bridge.rs.h"

#include <OpenImageIO/oiioversion.h>
#if OIIO_VERSION < 20400
#    error "spectra needs OpenImageIO 2.4 or later (Debian 12 and later: libopenimageio-dev)"
#endif
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace spectra {
namespace {

namespace Filesystem = OIIO::Filesystem;

std::string own(rust::Str text) { return std::string(text.data(), text.size()); }
std::string own(const rust::String &text) { return std::string(text.data(), text.size()); }

// Names and texts come from files and may hold any bytes.
rust::String lossy(const std::string &text) { return rust::String::lossy(text.data(), text.size()); }

[[noreturn]] void fail(std::string cause, const char *otherwise) {
    while (!cause.empty() && (cause.back() == '\n' || cause.back() == ' '))
        cause.pop_back();
    throw std::runtime_error(cause.empty() ? otherwise : cause);
}

// Turns any other exception into a std::exception, because it would end the program at the bridge.
template<class F> auto guarded(F body) {
    try {
        return body();
    } catch (const std::exception &) {
        throw;
    } catch (...) {
        throw std::runtime_error("OpenImageIO failed without an error message");
    }
}

// The library lists its formats when it is first asked for one. A second thread that asks meanwhile would get an incomplete list, so
// threads wait for each other here.
void know_formats() {
    static std::once_flag once;
    std::call_once(once, [] { OIIO::ImageInput::create("openexr"); });
}

// Passes the bytes that the library writes to Rust.
class ToRust final : public Filesystem::IOProxy {
public:
    explicit ToRust(Sink &sink) : IOProxy("", Write), m_sink(sink) {}
    const char *proxytype() const override { return "spectra"; }
    std::size_t write(const void *buffer, std::size_t size) override {
        const std::size_t done = pwrite(buffer, size, m_pos);
        m_pos += std::int64_t(done);
        return done;
    }
    std::size_t pwrite(const void *buffer, std::size_t size, std::int64_t offset) override {
        const std::lock_guard<std::mutex> lock(m_mutex);
        const auto *bytes = static_cast<const std::uint8_t *>(buffer);
        return m_sink.write_at(rust::Slice<const std::uint8_t>(bytes, size), offset) ? size : 0;
    }
    std::size_t size() const override { return std::size_t(m_sink.size()); }

private:
    Sink &m_sink;
    std::mutex m_mutex;
};

OIIO::ImageSpec spec_of(const Plan &plan) {
    OIIO::ImageSpec spec(plan.width, plan.height, int(plan.channels.size()), OIIO::TypeDesc(own(plan.samples)));
    spec.channelnames.clear();
    spec.alpha_channel = -1;
    for (std::size_t i = 0; i < plan.channels.size(); ++i) {
        spec.channelnames.push_back(own(plan.channels[i]));
        if (spec.channelnames.back() == "A")
            spec.alpha_channel = int(i);
    }
    spec.tile_width = spec.tile_height = plan.tile;
    spec.tile_depth = plan.tile > 0 ? 1 : 0;
    if (plan.pixel_aspect > 0.0F)
        spec.attribute("PixelAspectRatio", plan.pixel_aspect);
    for (std::size_t i = 0; i < plan.names.size(); ++i)
        spec.attribute(own(plan.names[i]), own(plan.texts[i]));
    for (std::size_t i = 0; i < plan.integer_names.size(); ++i)
        spec.attribute(own(plan.integer_names[i]), int(plan.integers[i]));
    return spec;
}

std::vector<float> rows_of(const Plan &plan, const Pixels &pixels, int first, int end) {
    std::vector<float> rows(std::size_t(end - first) * std::size_t(plan.width) * plan.channels.size());
    pixels.fill(first, rust::Slice<float>(rows.data(), rows.size()));
    return rows;
}

Header header_of(const OIIO::ImageSpec &spec) {
    Header header;
    header.data = { spec.x, spec.y, spec.width, spec.height };
    header.display = { spec.full_x, spec.full_y, spec.full_width, spec.full_height };
    header.slices = std::max(spec.depth, 1);
    header.deep = spec.deep;
    for (int channel = 0; channel < spec.nchannels; ++channel)
        header.channels.push_back(lossy(std::string(spec.channel_name(channel))));
    header.alpha = spec.alpha_channel;
    header.integers = !spec.format.is_floating_point();
    // The library translates only a few transfer characteristics of DPX files to a color space.
    const auto transfer = spec.get_string_attribute("dpx:Transfer");
    header.color_space = lossy(std::string(spec.get_string_attribute("oiio:ColorSpace", transfer)));
    header.orientation = spec.get_int_attribute("Orientation", 1);
    header.pixel_aspect = spec.get_float_attribute("PixelAspectRatio", 1.0F);
    header.straight = spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
    return header;
}

void read_opened(OIIO::ImageInput &input, const OIIO::ImageSpec &spec, Receiver &receiver) {
    const Header header = header_of(spec);
    const Wanted wanted = receiver.begin(header);
    if (wanted.end <= wanted.first)
        return;
    // Reads some rows at a time: whole strips or tiles of about 4 MiB.
    const std::size_t row = std::size_t(spec.width) * std::size_t(wanted.end - wanted.first);
    const bool tiled = spec.tile_width > 0;
    const int unit = std::max(tiled ? spec.tile_height : spec.get_int_attribute("tiff:RowsPerStrip", 64), 1);
    const auto most = std::int64_t((std::size_t(1) << 20) / row) / unit * unit;
    const int step = int(std::min(std::max(most, std::int64_t(unit)), std::int64_t(spec.height)));
    std::vector<float> values(row * std::size_t(step));
    for (int first = 0; first < spec.height; first += step) {
        const int end = std::min(first + step, spec.height);
        const bool good
            = tiled ? input.read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + first, spec.y + end, spec.z, spec.z + 1,
                                       wanted.first, wanted.end, OIIO::TypeDesc::FLOAT, values.data())
                    : input.read_scanlines(0, 0, spec.y + first, spec.y + end, spec.z, wanted.first, wanted.end,
                                           OIIO::TypeDesc::FLOAT, values.data());
        if (!good)
            fail(input.geterror(), "the pixels cannot be read");
        receiver.rows(first, rust::Slice<const float>(values.data(), row * std::size_t(end - first)));
    }
}

} // namespace

rust::String version() { return lossy(OIIO::get_string_attribute("version", OIIO_VERSION_STRING)); }

rust::String endings() {
    return guarded([] {
        know_formats();
        std::string all;
        // The extension list includes formats that can only be written.
        const auto formats = OIIO::Strutil::splits(OIIO::get_string_attribute("input_format_list"), ",");
        for (const auto &entry : OIIO::Strutil::splits(OIIO::get_string_attribute("extension_list"), ";")) {
            const auto format = entry.substr(0, entry.find(':'));
            if (std::find(formats.begin(), formats.end(), format) != formats.end())
                all += (all.empty() ? "" : ";") + entry;
        }
        return lossy(all);
    });
}

bool reads_memory(rust::Str format) {
    return guarded([&] {
        know_formats();
        auto input = OIIO::ImageInput::create(own(format));
        if (!input)
            fail(OIIO::geterror(), "no such format");
        return input->supports("ioproxy") != 0;
    });
}

void read(rust::Str format, rust::Str path, bool from_memory, rust::Slice<const std::uint8_t> bytes, Receiver &receiver) {
    guarded([&] {
        know_formats();
        Filesystem::IOMemReader memory(const_cast<std::uint8_t *>(bytes.data()), bytes.size());
        auto input = OIIO::ImageInput::create(own(format));
        if (!input)
            fail(OIIO::geterror(), "no such format");
        OIIO::ImageSpec wish, spec;
        // The library would multiply code values by alpha, which darkens edges.
        wish.attribute("oiio:UnassociatedAlpha", 1);
        if (from_memory)
            input->set_ioproxy(&memory);
        if (!input->open(own(path), spec, wish))
            fail(input->geterror(), "the file cannot be opened");
        read_opened(*input, spec, receiver);
        input->close();
    });
}

void write(const Plan &plan, const Pixels &pixels, Sink &sink) {
    guarded([&] {
        know_formats();
        ToRust proxy(sink);
        auto output = OIIO::ImageOutput::create(own(plan.format));
        if (!output)
            fail(OIIO::geterror(), "no such format");
        if (!output->supports("ioproxy"))
            throw std::runtime_error("the format cannot be written to an open file");
        output->set_ioproxy(&proxy);
        const OIIO::ImageSpec spec = spec_of(plan);
        if (!output->open(own(plan.path), spec))
            fail(output->geterror(), "the file cannot be created");
        const int step = plan.tile > 0 ? plan.tile : 64;
        for (int first = 0; first < plan.height; first += step) {
            const int end = std::min(first + step, plan.height);
            const auto rows = rows_of(plan, pixels, first, end);
            const bool good = plan.tile > 0
                                  ? output->write_tiles(0, plan.width, first, end, 0, 1, OIIO::TypeDesc::FLOAT, rows.data())
                                  : output->write_scanlines(first, end, 0, OIIO::TypeDesc::FLOAT, rows.data());
            if (!good)
                fail(output->geterror(), "the pixels cannot be written");
        }
        if (!output->close())
            fail(output->geterror(), "the file cannot be completed");
    });
}

void make_texture(const Plan &plan, const Pixels &pixels, rust::Str path) {
    guarded([&] {
        know_formats();
        const OIIO::ImageSpec spec = spec_of(plan);
        OIIO::ImageBuf buffer(spec);
        const auto rows = rows_of(plan, pixels, 0, plan.height);
        if (!buffer.set_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, rows.data()))
            fail(buffer.geterror(), "the pixels cannot be copied");
        OIIO::ImageSpec wish;
        wish.attribute("maketx:filtername", "box");
        if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, buffer, own(path), wish))
            fail(OIIO::geterror(), "the texture cannot be written");
    });
}

} // namespace spectra
