#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/golden.hpp"
#include "ui/gl/framebuffer.hpp"
#include "ui/gl/mipmaps.hpp"
#include "ui/gl/program.hpp"
#include "ui/shell/graphics_context.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A context of its own for each test.
class GlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    context_ = make_offscreen_context();
    context_->make_current();
    gl_ =
        std::make_unique<Gl>(load_gl([this](const char* name) { return context_->get_proc_address(name); }));
    errors_ = std::make_unique<GlErrorLog>(*gl_);
  }
  void TearDown() override {
    EXPECT_THAT(errors_->take(), IsEmpty());
    errors_.reset();
    context_->release_current();
  }

  std::unique_ptr<GraphicsContext> context_;
  std::unique_ptr<Gl> gl_;
  std::unique_ptr<GlErrorLog> errors_;
};

TEST_F(GlTest, ErrorsAreCollected) {
  gl_->Enable(0xFFFF);
  EXPECT_THAT(errors_->take(), Not(IsEmpty()));
  EXPECT_THAT(errors_->take(), IsEmpty());
}

TEST_F(GlTest, AShaderThatDoesNotCompileIsToldInOneSentence) {
  try {
    Program(*gl_, "broken", "#version 330 core\nvoid main() { gl_Position = wrong; }",
            "#version 330 core\nvoid main() {}");
    FAIL() << "it compiled";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("shader broken.vert does not compile: "));
    EXPECT_THAT(error.what(), HasSubstr("wrong"));
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    // The driver says it a second time by its own way.
    (void)errors_->take();
  }
}

TEST_F(GlTest, FramebufferReadsBackTopRowFirst) {
  for (const int samples : {0, 4}) {
    const Framebuffer target(*gl_, 8, 6, samples);
    target.bind();
    gl_->ClearColor(1.0F, 0.0F, 0.0F, 1.0F);
    gl_->Clear(GL_COLOR_BUFFER_BIT);
    gl_->Enable(GL_SCISSOR_TEST);
    gl_->Scissor(0, 4, 8, 2);
    gl_->ClearColor(0.0F, 0.0F, 1.0F, 1.0F);
    gl_->Clear(GL_COLOR_BUFFER_BIT);
    gl_->Disable(GL_SCISSOR_TEST);
    target.resolve();
    const cv::Mat image = target.read();
    ASSERT_EQ(image.size(), cv::Size(8, 6));
    EXPECT_EQ(image.at<cv::Vec3b>(0, 3), cv::Vec3b(255, 0, 0));
    EXPECT_EQ(image.at<cv::Vec3b>(1, 3), cv::Vec3b(255, 0, 0));
    EXPECT_EQ(image.at<cv::Vec3b>(2, 3), cv::Vec3b(0, 0, 255));
    EXPECT_EQ(image.at<cv::Vec3b>(5, 7), cv::Vec3b(0, 0, 255));
  }
}

TEST_F(GlTest, LevelsAreThoseTheDriverWouldMake) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(64, 48)}) {
    cv::Mat image(size, CV_8UC4);
    cv::randu(image, 0, 256);
    const std::vector<cv::Mat> levels = halved_levels(image);
    ASSERT_GE(levels.size(), 4U);
    Texture texture(*gl_, Sampling::kNearest);
    texture.upload(image);
    gl_->GenerateMipmap(GL_TEXTURE_2D);
    GLuint framebuffer = 0;
    gl_->GenFramebuffers(1, &framebuffer);
    gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    for (int i = 0; i < static_cast<int>(levels.size()); ++i) {
      const cv::Mat& level = levels[static_cast<std::size_t>(i)];
      gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.id(), i + 1);
      gl_->ReadBuffer(GL_COLOR_ATTACHMENT0);
      cv::Mat read(level.size(), CV_8UC4);
      gl_->ReadPixels(0, 0, read.cols, read.rows, GL_BGRA, GL_UNSIGNED_BYTE, read.data);
      EXPECT_LE(cv::norm(read, level, cv::NORM_INF), gl_->renderer.starts_with("llvmpipe") ? 0.0 : 2.0) << i;
    }
    gl_->DeleteFramebuffers(1, &framebuffer);
  }
}

/// What a texture looks like when drawn over a whole framebuffer, through shaders/image.
cv::Mat drawn(const Gl& gl, const Texture& texture, int width, int height) {
  const Framebuffer target(gl, width, height);
  const float quad[] = {-1, 1, 0, 0, 0, 1, 1, 0, 1, 0, -1, -1, 0, 0, 1, 1, -1, 0, 1, 1};
  const GlObject array = make_vertex_array(gl), buffer = make_buffer(gl);
  gl.BindVertexArray(array.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  gl.BufferData(GL_ARRAY_BUFFER, sizeof(quad), quad, GL_STATIC_DRAW);
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 20, nullptr);
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 20, reinterpret_cast<const void*>(12));
  const Program program = Program::embedded(gl, "image");
  target.bind();
  program.use();
  program.set("clip_from_world", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
  program.set("image", 0);
  program.set("opacity", 1.0F);
  gl.BindTexture(GL_TEXTURE_2D, texture.id());
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  target.resolve();
  return target.read();
}

cv::Mat drawn(const Gl& gl, const Texture& texture) {
  return drawn(gl, texture, texture.width(), texture.height());
}

TEST_F(GlTest, SidesThatCannotBeHalvedAreLeftToTheDriver) {
  EXPECT_TRUE(halved_levels(cv::Mat(375, 1242, CV_8UC3)).empty());
  EXPECT_TRUE(halved_levels(cv::Mat(481, 641, CV_8UC1)).empty());
  EXPECT_TRUE(halved_levels(cv::Mat()).empty());
  EXPECT_EQ(halved_levels(cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.5))).back().at<float>(3, 4), 0.5F);
  // From the one to the other and back, in one texture. A level that is missing, or left from before, would
  // show where it is drawn smaller.
  Texture texture(*gl_);
  int grey = 0;
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(63, 47), cv::Size(64, 48), cv::Size(640, 480),
                              cv::Size(1242, 375), cv::Size(1, 1), cv::Size(256, 256), cv::Size(37, 2)})
    for (const int type : {CV_8UC3, CV_8UC1, CV_8UC4}) {
      const int is = grey = (grey + 37) % 256;
      texture.upload(cv::Mat(size, type, cv::Scalar(is, is, is, 255)));
      for (const int smaller : {1, 2, 3, 5, 8, 16, 30}) {
        const cv::Mat shown =
            drawn(*gl_, texture, std::max(1, size.width / smaller), std::max(1, size.height / smaller));
        EXPECT_LE(cv::norm(shown, cv::Mat(shown.size(), CV_8UC3, cv::Scalar::all(is)), cv::NORM_INF), 1.0)
            << size << " of type " << type << " drawn " << smaller << " times smaller";
      }
    }
}

TEST_F(GlTest, SmallerIsTheMeanOfWhatIsUnderIt) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(641, 479)}) {
    cv::Mat image(size, CV_8UC3);
    cv::randu(image, 0, 256);
    cv::GaussianBlur(image, image, {}, 4.0);
    Texture texture(*gl_);
    texture.upload(image);
    cv::Mat expected;
    cv::resize(image, expected, {size.width / 4, size.height / 4}, 0, 0, cv::INTER_AREA);
    const cv::Mat shown = drawn(*gl_, texture, expected.cols, expected.rows);
    EXPECT_LT(cv::norm(shown, expected, cv::NORM_L1) / static_cast<double>(3 * expected.total()), 1.5)
        << size;
  }
}

TEST_F(GlTest, TexturesShowImagesAsOpenCvHoldsThem) {
  cv::Mat colour(5, 7, CV_8UC3), grey(5, 7, CV_8UC1), real(5, 7, CV_32FC1), with_alpha(5, 7, CV_8UC4);
  cv::randu(colour, 0, 256);
  cv::randu(grey, 0, 256);
  cv::randu(with_alpha, 0, 256);
  for (int i = 0; i < 35; ++i) real.at<float>(i / 7, i % 7) = static_cast<float>(i * 7) / 255.0F;
  Texture texture(*gl_, Sampling::kNearest);
  const ImageTolerance exact{1, 0.0, 0.0};

  texture.upload(colour);
  EXPECT_TRUE(images_agree(drawn(*gl_, texture), colour, exact));
  cv::Mat expected;
  texture.upload(grey);
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, expected);
  EXPECT_TRUE(images_agree(drawn(*gl_, texture), expected, exact));
  texture.upload(real);
  cv::Mat bytes;
  real.convertTo(bytes, CV_8U, 255.0);
  cv::merge(std::vector<cv::Mat>{bytes, bytes, bytes}, expected);
  EXPECT_TRUE(images_agree(drawn(*gl_, texture), expected, exact));
  texture.upload(with_alpha);
  std::vector<cv::Mat> channels;
  cv::split(with_alpha, channels);
  channels.pop_back();
  cv::merge(channels, expected);
  EXPECT_TRUE(images_agree(drawn(*gl_, texture), expected, exact));
}

TEST_F(GlTest, TexturesTakeImagesWithPaddedRows) {
  cv::Mat whole(20, 30, CV_8UC3);
  cv::randu(whole, 0, 256);
  const cv::Mat part = whole(cv::Rect(3, 4, 11, 9));
  Texture texture(*gl_, Sampling::kNearest);
  texture.upload(part);
  EXPECT_TRUE(images_agree(drawn(*gl_, texture), part, {1, 0.0, 0.0}));
}

TEST_F(GlTest, TexturesRefuseWhatTheyCannotShow) {
  Texture texture(*gl_);
  EXPECT_THROW(texture.upload(cv::Mat(4, 4, CV_64FC2)), std::invalid_argument);
  texture.upload(cv::Mat());
  EXPECT_TRUE(texture.empty());
}

}  // namespace
}  // namespace stillpoint::testing
