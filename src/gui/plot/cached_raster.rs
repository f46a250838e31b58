//! Cached raster image that shows many static curves.

use egui::{
    Color32, ColorImage, Context, Pos2, Rect, Shape, Stroke, TextureHandle, TextureOptions, pos2,
};
use vello_cpu::color::AlphaColor;
use vello_cpu::kurbo::{Affine, BezPath, Circle, Join, Shape as _, Stroke as PathStroke};
use vello_cpu::{Pixmap, RenderContext, RenderSettings, Resources};

use super::curve_style::CurveStyle;

/// Minimum number of curves for which an image as large as a pane is worth its memory: filling
/// their lines takes longer than all other work in a frame.
pub(super) const MANY: usize = 200;
/// Maximum deviation between a drawn circle and a true circle \[pt\].
const TOLERANCE: f64 = 0.05;

/// Content of an image; the image is valid while its content is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RasterScene {
    /// Place on the screen \[pt\].
    pub(super) frame: Rect,
    pub(super) pixels_per_point: f32,
    /// Serial number and style for each curve, from bottom to top.
    pub(super) curves: Vec<(u64, CurveStyle)>,
}

/// Cached image that shows many static curves. Without a graphics processor, filling a thousand
/// curves' lines dominates the frame time, although none of them moves with the pointer.
///
/// ```text
/// scene changed since the last frame:  draw the lines; drop the image
/// same scene, no image yet:            fill the lines once, into an image
/// same scene, with its image:          draw a rectangle
/// ```
#[derive(Clone, Default)]
pub(super) struct CachedRaster {
    scene: Option<RasterScene>,
    image: Option<RasterImage>,
}

impl std::fmt::Debug for CachedRaster {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("CachedRaster")
            .field("scene", &self.scene)
            .finish_non_exhaustive()
    }
}

impl CachedRaster {
    /// Returns the image if `scene` has not changed since the last frame; `shapes` creates its
    /// content. `None` if the lines must be drawn instead: the scene has changed, or the image
    /// would be larger than a texture may be.
    pub(super) fn image_once_static(
        &mut self,
        ctx: &Context,
        scene: RasterScene,
        shapes: impl FnOnce() -> Vec<Shape>,
    ) -> Option<RasterImage> {
        if self.scene.as_ref() != Some(&scene) {
            self.expect(scene);
            // A changing scene is drawn as lines; the next frame shows whether it has become
            // static.
            ctx.request_repaint();
            return None;
        }
        self.image_at_once(ctx, scene, shapes)
    }

    /// Drops the image, and expects this scene in the next frame.
    fn expect(&mut self, scene: RasterScene) {
        *self = Self {
            scene: Some(scene),
            image: None,
        };
    }

    /// Returns an image that shows `scene`, even if it has just changed: small images are filled
    /// faster than their lines are drawn. `None` if it would be larger than a texture may be.
    pub(super) fn image_at_once(
        &mut self,
        ctx: &Context,
        scene: RasterScene,
        shapes: impl FnOnce() -> Vec<Shape>,
    ) -> Option<RasterImage> {
        let frame = scene.frame;
        let pixels_per_point = scene.pixels_per_point;
        if self.scene.as_ref() != Some(&scene) {
            self.expect(scene);
        }
        if self.image.is_none() {
            let area = whole_pixels(frame, pixels_per_point)?;
            let largest = ctx.input(|input| input.max_texture_side);
            if area.pixels.iter().any(|side| usize::from(*side) > largest) {
                return None;
            }
            let image = filled(&shapes(), &area);
            self.image = Some(RasterImage {
                texture: ctx.load_texture("curves at rest", image, TextureOptions::NEAREST),
                area: area.rect,
            });
        }
        self.image.clone()
    }
}

/// Screen area made up of whole pixels.
struct PixelArea {
    /// Place \[pt\].
    rect: Rect,
    pixels_per_point: f32,
    /// Width and height \[pixels\].
    pixels: [u16; 2],
}

/// Returns the smallest area in whole pixels that contains `frame`; `None` if an image cannot be
/// that large.
fn whole_pixels(frame: Rect, pixels_per_point: f32) -> Option<PixelArea> {
    let min = (frame.min * pixels_per_point).floor();
    let max = (frame.max * pixels_per_point).ceil();
    let pixels = [pixel_count(max.x - min.x)?, pixel_count(max.y - min.y)?];
    Some(PixelArea {
        rect: Rect::from_min_max(min / pixels_per_point, max / pixels_per_point),
        pixels_per_point,
        pixels,
    })
}

/// Returns a length in pixels; `None` if it is outside the limits for an image.
fn pixel_count(length: f32) -> Option<u16> {
    if (1.0..=f32::from(u16::MAX)).contains(&length) {
        Some(length as u16)
    } else {
        None
    }
}

/// Renders the shapes on a transparent ground.
fn filled(shapes: &[Shape], area: &PixelArea) -> ColorImage {
    let [width, height] = area.pixels;
    let mut context = RenderContext::new_with(
        width,
        height,
        RenderSettings {
            num_threads: 0,
            ..Default::default()
        },
    );
    let scale = f64::from(area.pixels_per_point);
    let origin = area.rect.min;
    let shift = (-f64::from(origin.x), -f64::from(origin.y));
    context.set_transform(Affine::scale(scale) * Affine::translate(shift));
    for shape in shapes {
        fill(&mut context, shape);
    }
    context.flush();
    let mut pixmap = Pixmap::new(width, height);
    context.render(&mut pixmap, &mut Resources::new());
    ColorImage::from_rgba_premultiplied(
        [usize::from(width), usize::from(height)],
        pixmap.data_as_u8_slice(),
    )
}

/// Strokes lines, and fills dots' discs.
fn fill(context: &mut RenderContext, shape: &Shape) {
    match shape {
        Shape::Vec(shapes) => {
            for shape in shapes {
                fill(context, shape);
            }
        }
        Shape::LineSegment { points, stroke } => stroke_along(context, points, *stroke),
        Shape::Path(path) => {
            if let egui::epaint::ColorMode::Solid(color) = path.stroke.color {
                stroke_along(context, &path.points, Stroke::new(path.stroke.width, color));
            }
        }
        Shape::Circle(circle) => {
            set_paint_color(context, circle.fill);
            let disc = Circle::new(
                (f64::from(circle.center.x), f64::from(circle.center.y)),
                f64::from(circle.radius),
            );
            context.fill_path(&disc.to_path(TOLERANCE));
        }
        // `CurveStyle::add_shapes` makes nothing else.
        _ => debug_assert!(false, "a line is made of strokes and dots"),
    }
}

fn stroke_along(context: &mut RenderContext, points: &[Pos2], stroke: Stroke) {
    let mut path = BezPath::new();
    for (index, point) in points.iter().enumerate() {
        let at = (f64::from(point.x), f64::from(point.y));
        if index == 0 {
            path.move_to(at);
        } else {
            path.line_to(at);
        }
    }
    set_paint_color(context, stroke.color);
    context.set_stroke(PathStroke::new(f64::from(stroke.width)).with_join(Join::Bevel));
    context.stroke_path(&path);
}

fn set_paint_color(context: &mut RenderContext, color: Color32) {
    let [red, green, blue, alpha] = color.to_srgba_unmultiplied();
    context.set_paint(AlphaColor::from_rgba8(red, green, blue, alpha));
}

/// Image on whole pixels, ready to be drawn. (A `PlotImage` would lie below all other items,
/// including bands, and would be scaled in plot coordinates.)
#[derive(Clone)]
pub(super) struct RasterImage {
    texture: TextureHandle,
    area: Rect,
}

impl RasterImage {
    /// Returns the image with this opacity, from 0 to 1.
    pub(super) fn shape(&self, strength: f32) -> Shape {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        Shape::image(
            self.texture.id(),
            self.area,
            whole,
            Color32::WHITE.gamma_multiply(strength),
        )
    }
}

#[cfg(test)]
mod tests {
    use egui::{RawInput, vec2};

    use gdcm_plot::figure::drawing::Dash;

    use super::*;

    fn scene(curves: &[u64], left: f32) -> RasterScene {
        let look = CurveStyle {
            color: Color32::RED,
            width: 2.0,
            dash: Dash::Solid,
            length: 0.0,
        };
        let frame = Rect::from_min_size(pos2(left, 20.3), vec2(50.0, 30.0));
        RasterScene {
            frame,
            pixels_per_point: 1.5,
            curves: curves.iter().map(|serial| (*serial, look)).collect(),
        }
    }

    /// Returns the rectangle into which the image is drawn.
    fn image(still: &mut CachedRaster, ctx: &Context, scene: RasterScene) -> Option<Rect> {
        still
            .image_once_static(ctx, scene, Vec::new)
            .map(|item| item.area)
    }

    #[test]
    fn static_curves_become_an_image_until_they_move() {
        let ctx = Context::default();
        ctx.run_ui(RawInput::default(), |_| {})
            .drop_without_applying_deltas();
        let mut still = CachedRaster::default();
        assert_eq!(
            image(&mut still, &ctx, scene(&[1, 2], 10.2)),
            None,
            "the first frame may be part of a motion"
        );
        let area = image(&mut still, &ctx, scene(&[1, 2], 10.2)).expect("the scene is static");
        assert!(area.contains_rect(scene(&[], 10.2).frame));
        let pixels = area.scale_from_center(1.0).min * 1.5;
        assert!(
            (pixels - pixels.round()).length() < 1e-4,
            "on whole pixels: {pixels:?}"
        );
        assert_eq!(
            image(&mut still, &ctx, scene(&[1, 2], 11.2)),
            None,
            "the frame moved"
        );
        assert_eq!(
            image(&mut still, &ctx, scene(&[1, 3], 11.2)),
            None,
            "a curve has other points"
        );
        assert!(image(&mut still, &ctx, scene(&[1, 3], 11.2)).is_some());
    }

    #[test]
    fn lines_and_dots_are_filled_where_they_are() {
        let red = Color32::from_rgba_unmultiplied(200, 0, 0, 204);
        let shapes = [
            Shape::line(
                vec![pos2(10.0, 25.0), pos2(60.0, 25.0)],
                Stroke::new(2.0, red),
            ),
            Shape::circle_filled(pos2(40.0, 40.0), 3.0, Color32::BLUE),
        ];
        let area = PixelArea {
            rect: Rect::from_min_size(pos2(10.0, 20.0), vec2(50.0, 30.0)),
            pixels_per_point: 2.0,
            pixels: [100, 60],
        };
        let image = filled(&shapes, &area);
        // Premultiplied colours may differ by 1 because of rounding.
        let near = |[x, y]: [usize; 2], color: Color32| {
            image[(x, y)]
                .to_array()
                .iter()
                .zip(color.to_array())
                .all(|(a, b)| a.abs_diff(b) <= 1)
        };
        assert!(
            near([50, 9], red) && near([50, 10], red),
            "{:?}",
            image[(50, 9)]
        );
        assert!(near([60, 40], Color32::BLUE));
        assert!(near([50, 6], Color32::TRANSPARENT) && near([50, 14], Color32::TRANSPARENT));
    }
}
