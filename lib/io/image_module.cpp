// SPDX-License-Identifier: MIT
// OpenImageIO behind plain C: the module paravent_image. Nothing is thrown out of it.
#include "image_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>
#ifdef PVT_LEAK_CHECK
#include <sanitizer/lsan_interface.h>
#endif

#define PVT_EXPORT __attribute__((visibility("default")))

extern "C" PVT_EXPORT pvtGetImageModuleFcn pvtGetImageModule;

namespace
{

struct OpenImage {
    std::unique_ptr<OIIO::Filesystem::IOMemReader> reader; // must outlive `input`
    std::unique_ptr<OIIO::ImageInput> input;
    int width = 0, height = 0, channels = 0;
    int alphaChannel = -1; // of an image opened from memory
    bool isLinear = false; // floats, as in EXR, are not sRGB yet
};

void Tell(pvtImageText* error, const std::string& text)
{
    (void)std::snprintf(error->text, sizeof error->text, "%s", text.c_str());
}

// OpenImageIO keeps its last error in memory of the thread, where LeakSanitizer does not look.
class LeakCheckPause
{
  public:
    LeakCheckPause()
    {
#ifdef PVT_LEAK_CHECK
        __lsan_disable();
#endif
    }
    ~LeakCheckPause()
    {
#ifdef PVT_LEAK_CHECK
        __lsan_enable();
#endif
    }
    LeakCheckPause(const LeakCheckPause&) = delete;
    LeakCheckPause& operator=(const LeakCheckPause&) = delete;
};

// Runs `body`; what it throws becomes a text and `failed`.
template <class Result, class Body> Result Guard(pvtImageText* error, Result failed, Body body)
{
    try {
        return body();
    } catch (const std::bad_alloc&) {
        Tell(error, "memory ran out");
    } catch (const std::exception& thrown) {
        Tell(error, thrown.what());
    } catch (...) {
        Tell(error, "OpenImageIO failed");
    }
    return failed;
}

std::vector<unsigned char> Encode(const std::uint8_t* pixels, int width, int height)
{
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput writer(bytes);
    auto output = OIIO::ImageOutput::create("png");
    if (output == nullptr) {
        throw std::runtime_error(OIIO::geterror());
    }
    OIIO::ImageSpec spec(width, height, 4, OIIO::TypeDesc::UINT8);
    // The colours are what they are, whatever the alpha.
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", "sRGB");
    output->set_ioproxy(&writer);
    const bool written = output->open("image.png", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, pixels) && output->close();
    if (!written) {
        throw std::runtime_error(output->geterror());
    }
    return bytes;
}

std::uint8_t* EncodePng(const std::uint8_t* pixels, int width, int height, std::size_t* size,
                        pvtImageText* error)
{
    return Guard<std::uint8_t*>(error, nullptr, [&] {
        const std::vector<unsigned char> bytes = Encode(pixels, width, height);
        auto* copy = static_cast<std::uint8_t*>(std::malloc(bytes.size()));
        if (copy == nullptr) {
            throw std::bad_alloc();
        }
        std::memcpy(copy, bytes.data(), bytes.size());
        *size = bytes.size();
        return copy;
    });
}

void Release(std::uint8_t* bytes)
{
    std::free(bytes);
}

void* Open(const char* path, const std::uint8_t* bytes, std::size_t size, int* width, int* height,
           pvtImageText* error)
{
    const LeakCheckPause pause;
    return Guard<void*>(error, nullptr, [&]() -> void* {
        auto image = std::make_unique<OpenImage>();
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        image->reader = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes, size);
        image->input = OIIO::ImageInput::open(path, &config, image->reader.get());
        if (image->input == nullptr) {
            // The format cannot be read from memory.
            (void)OIIO::geterror();
            image->input = OIIO::ImageInput::open(path, &config);
        }
        if (image->input == nullptr) {
            Tell(error, OIIO::geterror());
            return nullptr;
        }
        const OIIO::ImageSpec& spec = image->input->spec();
        if (spec.nchannels < 1 || spec.depth > 1) {
            Tell(error, "it is not a flat picture");
            return nullptr;
        }
        *width = image->width = spec.width;
        *height = image->height = spec.height;
        image->channels = spec.nchannels < 4 ? spec.nchannels : 4;
        image->isLinear = spec.format.is_floating_point();
        return image.release();
    });
}

std::uint8_t Quantize(float value)
{
    const float scaled = value * 255.0f + 0.5f;
    // NaN compares false, and becomes 0.
    return scaled >= 255.0f ? 255 : scaled > 0.0f ? static_cast<std::uint8_t>(scaled) : 0;
}

// The curve of IEC 61966-2-1.
float EncodeSrgb(float linear)
{
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

// Grey and alpha, or colours, from `channels` values.
void SpreadChannels(const std::uint8_t* in, int channels, std::uint8_t out[4])
{
    const bool isGrey = channels < 3;
    out[0] = in[0];
    out[1] = isGrey ? in[0] : in[1];
    out[2] = isGrey ? in[0] : in[2];
    out[3] = channels == 2 ? in[1] : channels == 4 ? in[3] : 255;
}

void ConvertRow(const OpenImage& image, const float* in, std::uint8_t* out)
{
    const int colours = image.channels < 3 ? 1 : 3;
    for (int x = 0; x < image.width; ++x, in += image.channels, out += 4) {
        std::uint8_t values[4] = {0, 0, 0, 0};
        for (int c = 0; c < image.channels && c < 4; ++c) {
            values[c] = Quantize(c < colours ? EncodeSrgb(in[c]) : in[c]);
        }
        SpreadChannels(values, image.channels, out);
    }
}

bool ReadPixels(OpenImage& image, std::uint8_t* pixels)
{
    const std::size_t count = static_cast<std::size_t>(image.width) *
                              static_cast<std::size_t>(image.height) *
                              static_cast<std::size_t>(image.channels);
    if (image.isLinear) {
        std::vector<float> values(count);
        if (!image.input->read_image(0, 0, 0, image.channels, OIIO::TypeDesc::FLOAT,
                                     values.data())) {
            return false;
        }
        for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
            const std::size_t row = y * static_cast<std::size_t>(image.width);
            ConvertRow(image, values.data() + row * static_cast<std::size_t>(image.channels),
                       pixels + row * 4);
        }
        return true;
    }
    std::vector<std::uint8_t> values(count);
    if (!image.input->read_image(0, 0, 0, image.channels, OIIO::TypeDesc::UINT8, values.data())) {
        return false;
    }
    const std::size_t channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < count / channels; ++i) {
        SpreadChannels(values.data() + i * channels, image.channels, pixels + 4 * i);
    }
    return true;
}

bool Read(void* handle, std::uint8_t* pixels, pvtImageText* error)
{
    const LeakCheckPause pause;
    return Guard(error, false, [&] {
        auto* image = static_cast<OpenImage*>(handle);
        if (!ReadPixels(*image, pixels)) {
            Tell(error, image->input->geterror());
            return false;
        }
        return true;
    });
}

// By the name of the format, so that no other reader and no file is tried.
void* OpenMemory(const char* format, const std::uint8_t* bytes, std::size_t size,
                 pvtImageShape* shape, pvtImageText* error)
{
    const LeakCheckPause pause;
    return Guard<void*>(error, nullptr, [&]() -> void* {
        auto image = std::make_unique<OpenImage>();
        image->reader = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes, size);
        image->input = OIIO::ImageInput::create(format);
        if (image->input == nullptr) {
            Tell(error, OIIO::geterror());
            return nullptr;
        }
        OIIO::ImageSpec config, spec;
        config.attribute("oiio:UnassociatedAlpha", 1);
        if (image->input->supports("ioproxy") == 0 ||
            !image->input->set_ioproxy(image->reader.get()) ||
            !image->input->open(std::string("memory.") + format, spec, config)) {
            Tell(error, image->input->geterror());
            return nullptr;
        }
        if (spec.nchannels < 1 || spec.depth > 1 || spec.width < 1 || spec.height < 1 ||
            spec.tile_width != 0) {
            Tell(error, "it is not a flat picture");
            return nullptr;
        }
        image->width = spec.width;
        image->height = spec.height;
        image->channels = spec.nchannels;
        image->alphaChannel = spec.alpha_channel;
        *shape = {spec.width, spec.height, spec.alpha_channel >= 0};
        return image.release();
    });
}

bool ReadAlphaRows(OpenImage& image, int firstRow, int rowCount, std::uint8_t* alpha)
{
    const OIIO::ImageSpec& spec = image.input->spec();
    const int begin = spec.y + firstRow, end = begin + rowCount, channel = image.alphaChannel;
    if (spec.format == OIIO::TypeDesc::UINT8) {
        return image.input->read_scanlines(0, 0, begin, end, 0, channel, channel + 1,
                                           OIIO::TypeDesc::UINT8, alpha);
    }
    const std::size_t count =
        static_cast<std::size_t>(rowCount) * static_cast<std::size_t>(image.width);
    std::vector<std::uint16_t> values(count);
    if (!image.input->read_scanlines(0, 0, begin, end, 0, channel, channel + 1,
                                     OIIO::TypeDesc::UINT16, values.data())) {
        return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
        alpha[i] = static_cast<std::uint8_t>(values[i] / 257);
    }
    return true;
}

bool ReadAlpha(void* handle, int firstRow, int rowCount, std::uint8_t* alpha, pvtImageText* error)
{
    const LeakCheckPause pause;
    return Guard(error, false, [&] {
        auto* image = static_cast<OpenImage*>(handle);
        if (!ReadAlphaRows(*image, firstRow, rowCount, alpha)) {
            Tell(error, image->input->geterror());
            return false;
        }
        return true;
    });
}

void Close(void* handle)
{
    delete static_cast<OpenImage*>(handle);
}

} // namespace

extern "C" const pvtImageModule* pvtGetImageModule(void)
{
    static const pvtImageModule module = {
        PVT_IMAGE_MODULE_VERSION, EncodePng, Release, Open, Read, Close, OpenMemory, ReadAlpha,
    };
    return &module;
}
