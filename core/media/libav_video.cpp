#include "core/media/libav_video.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr int kTicks = 60000;       // a second, of frames' own times: MPEG-4 bears no more than 65535
constexpr int kKeyframeEvery = 30;  // frames: one can be gone to without decoding many
constexpr int kMjpegQuality = 3;    // 1 (best) to 31

struct FreeAv {
  void operator()(AVFormatContext* file) const {
    if (file->pb != nullptr) avio_closep(&file->pb);
    avformat_free_context(file);
  }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <typename T>
using Av = std::unique_ptr<T, FreeAv>;

/// H.264 or MPEG-4, in BT.709's colours at limited range; Motion JPEG in JPEG's own. The same images give the
/// same bytes: one thread, no random ids.
class LibavVideo final : public VideoSink {
 public:
  bool open(const std::string& path, const cv::Size& size, double step_s) override {
    av_log_set_level(AV_LOG_QUIET);
    AVFormatContext* file = nullptr;
    if (avformat_alloc_output_context2(&file, nullptr, nullptr, path.c_str()) < 0) return false;
    file_.reset(file);
    file_->flags |= AVFMT_FLAG_BITEXACT;
    steady_ = path.ends_with(".avi");
    return open_encoder(size, step_s) && begin_file(path);
  }

  bool write(const cv::Mat& image, double seconds) override {
    const std::int64_t next = stamps_.empty() ? 0 : stamps_.back() + 1;
    const auto wanted = static_cast<std::int64_t>(std::llround(seconds * kTicks));
    stamps_.push_back(steady_ ? next : std::max(next, wanted));
    if (av_frame_make_writable(frame_.get()) < 0) return false;
    const std::uint8_t* const rows[] = {image.data};
    const int strides[] = {static_cast<int>(image.step)};
    sws_scale(scaler_.get(), rows, strides, 0, image.rows, frame_->data, frame_->linesize);
    frame_->pts = stamps_.back();
    return avcodec_send_frame(codec_.get(), frame_.get()) >= 0 && write_packets();
  }

  bool close() override {
    const bool whole = avcodec_send_frame(codec_.get(), nullptr) >= 0 && write_packets() &&
                       av_write_trailer(file_.get()) >= 0;
    return avio_closep(&file_->pb) >= 0 && whole;
  }

 private:
  bool open_encoder(const cv::Size& size, double step_s) {
    const AVCodec* encoder =
        steady_ ? avcodec_find_encoder(AV_CODEC_ID_MJPEG) : avcodec_find_encoder_by_name("libx264");
    if (encoder == nullptr && !steady_) encoder = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
    if (encoder == nullptr) return false;
    codec_.reset(avcodec_alloc_context3(encoder));
    codec_->width = size.width, codec_->height = size.height;
    codec_->framerate = av_d2q(1.0 / step_s, 1000);
    codec_->time_base = steady_ ? av_inv_q(codec_->framerate) : AVRational{1, kTicks};
    codec_->thread_count = 1;
    codec_->flags |= AV_CODEC_FLAG_BITEXACT;
    codec_->max_b_frames = 0;
    if (steady_) {
      codec_->pix_fmt = AV_PIX_FMT_YUVJ420P;
      codec_->color_range = AVCOL_RANGE_JPEG;
    } else {
      codec_->pix_fmt = AV_PIX_FMT_YUV420P;
      codec_->color_range = AVCOL_RANGE_MPEG;
      codec_->colorspace = AVCOL_SPC_BT709;
      codec_->color_primaries = AVCOL_PRI_BT709;
      codec_->color_trc = AVCOL_TRC_BT709;
      codec_->gop_size = kKeyframeEvery;
    }
    if (encoder->id == AV_CODEC_ID_H264) {
      av_opt_set(codec_->priv_data, "crf", "18", 0);
      av_opt_set(codec_->priv_data, "preset", "fast", 0);
    } else {
      codec_->flags |= AV_CODEC_FLAG_QSCALE;
      codec_->global_quality = FF_QP2LAMBDA * kMjpegQuality;
    }
    if ((file_->oformat->flags & AVFMT_GLOBALHEADER) != 0) codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (avcodec_open2(codec_.get(), encoder, nullptr) < 0) return false;
    step_ = std::max<std::int64_t>(1, std::llround(step_s / av_q2d(codec_->time_base)));
    return open_scaler();
  }

  bool open_scaler() {
    const int width = codec_->width, height = codec_->height;
    frame_.reset(av_frame_alloc());
    frame_->format = codec_->pix_fmt, frame_->width = width, frame_->height = height;
    frame_->color_range = codec_->color_range, frame_->colorspace = codec_->colorspace;
    frame_->quality = codec_->global_quality;
    if (av_frame_get_buffer(frame_.get(), 0) < 0) return false;
    scaler_.reset(sws_getContext(width, height, AV_PIX_FMT_BGR24, width, height, AV_PIX_FMT_YUV420P,
                                 SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP | SWS_BITEXACT, nullptr,
                                 nullptr, nullptr));
    if (!scaler_) return false;
    const int* colours = sws_getCoefficients(steady_ ? SWS_CS_ITU601 : SWS_CS_ITU709);
    return sws_setColorspaceDetails(scaler_.get(), colours, 1, colours, steady_ ? 1 : 0, 0, 1 << 16,
                                    1 << 16) >= 0;
  }

  bool begin_file(const std::string& path) {
    stream_ = avformat_new_stream(file_.get(), nullptr);
    if (stream_ == nullptr || avcodec_parameters_from_context(stream_->codecpar, codec_.get()) < 0)
      return false;
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = codec_->framerate;
    packet_.reset(av_packet_alloc());
    return avio_open(&file_->pb, path.c_str(), AVIO_FLAG_WRITE) >= 0 &&
           avformat_write_header(file_.get(), nullptr) >= 0;
  }

  /// What the encoder has ready. Without B frames packets come in the order of frames.
  bool write_packets() {
    int result = 0;
    while ((result = avcodec_receive_packet(codec_.get(), packet_.get())) >= 0) {
      packet_->duration = packets_ + 1 < stamps_.size() ? stamps_[packets_ + 1] - stamps_[packets_] : step_;
      ++packets_;
      av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      if (av_interleaved_write_frame(file_.get(), packet_.get()) < 0) return false;
    }
    return result == AVERROR(EAGAIN) || result == AVERROR_EOF;
  }

  Av<AVFormatContext> file_;
  Av<AVCodecContext> codec_;
  Av<AVFrame> frame_;
  Av<AVPacket> packet_;
  Av<SwsContext> scaler_;
  AVStream* stream_ = nullptr;
  bool steady_ = false;               // the container has one frame rate and no stamps
  std::int64_t step_ = 1;             // ticks that the last frame is shown for
  std::vector<std::int64_t> stamps_;  // ticks, of the frames so far
  std::size_t packets_ = 0;
};

}  // namespace

std::unique_ptr<VideoSink> make_libav_video() { return std::make_unique<LibavVideo>(); }

}  // namespace stillpoint
