/* EXR pixels through OpenEXR's C++ library, which decodes DWAA and DWAB where its C library (before 3.2) does not. No
 * C++ type or exception leaves this file. */
#include "image/image_internal.h"

#include <cstring>
#include <exception>
#include <new>

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

namespace {

/* A file in memory. */
class memory_stream : public Imf::IStream {
  public:
    memory_stream(const char *name, const unsigned char *data, size_t size)
        : Imf::IStream(name), data_(data), size_(size)
    {
    }

    bool read(char bytes[], int count) override
    {
        if (count < 0 || at_ > size_ || static_cast<uint64_t>(count) > size_ - at_) {
            throw Iex::InputExc("the file is too short");
        }
        std::memcpy(bytes, data_ + at_, static_cast<size_t>(count));
        at_ += static_cast<uint64_t>(count);
        return at_ < size_;
    }

    uint64_t tellg() override
    {
        return at_;
    }

    void seekg(uint64_t position) override
    {
        at_ = position;
    }

  private:
    const unsigned char *data_;
    uint64_t size_;
    uint64_t at_ = 0;
};

void pixels_read(const char *name, const unsigned char *data, size_t size, const lmb_exr_target *targets, size_t count,
                 int32_t width)
{
    memory_stream stream(name, data, size);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    Imf::FrameBuffer buffer;
    for (size_t i = 0; i < count; ++i) {
        const size_t step = static_cast<size_t>(targets[i].stride) * sizeof(float);
        buffer.insert(targets[i].channel,
                      Imf::Slice::Make(Imf::FLOAT, targets[i].base, window, step, step * static_cast<size_t>(width)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
}

} // namespace

lmb_result lmb_exr_decode_dwa(const char *name, const unsigned char *data, size_t size, const lmb_exr_target *targets,
                              size_t count, int32_t width, lmb_error *error)
{
    try {
        pixels_read(name, data, size, targets, count, width);
        return LMB_OK;
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory to decode the EXR's pixels", name);
    } catch (const std::exception &fault) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cannot decode the EXR's pixels: %s", name, fault.what());
    } catch (...) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cannot decode the EXR's pixels", name);
    }
}
