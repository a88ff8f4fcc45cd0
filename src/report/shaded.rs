//! Surfaces as pictures: triangles seen from afar, shaded, the nearer before the farther.
//!
//! ```text
//! x_screen = right . x,  y_screen = up . x,  depth = toward . x          shade = ambient + (1 - ambient) max(0, n . light)
//! ```
//!
//! Normals are means over the facets about a vertex, weighted by their areas. Each pixel is the mean of four samples.

use resvg::tiny_skia;

use super::canvas;
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;
/// The share of light on what is turned away from it.
const AMBIENT: f64 = 0.42;
/// The height of the eye above the horizon, and how far it looks around, radians.
const ELEVATION: f64 = 0.2;
const AROUND: f64 = 0.3;
/// The share of a picture that stays free at each edge.
const MARGIN: f64 = 0.04;

/// Where a picture is seen from, and how large.
#[derive(Clone, Debug)]
pub struct Camera {
    right: Vec3,
    up: Vec3,
    toward: Vec3,
    /// What lies in the middle of the picture, mm.
    middle: Vec3,
    /// Pixels for each mm.
    scale: f64,
}

impl Camera {
    /// Looks from the side on what moves along `direction`, with z upwards, so that all of `points` (mm) are in a picture of `size`
    /// (pixels).
    #[must_use]
    pub fn beside<'a>(
        direction: Vec3,
        points: impl Iterator<Item = &'a Vec3> + Clone,
        size: [usize; 2],
    ) -> Self {
        let level = Vec3::new(direction.x, direction.y, 0.0).try_normalize(1e-9);
        let level = level.unwrap_or(Vec3::x());
        let side = level.cross(&Vec3::z());
        let looking = side * AROUND.cos() + level * AROUND.sin();
        let toward = looking * ELEVATION.cos() + Vec3::z() * ELEVATION.sin();
        let right = Vec3::z().cross(&toward).normalize();
        let up = toward.cross(&right);
        let mut camera = Self { right, up, toward, middle: Vec3::zeros(), scale: 1.0 };
        let places = points.map(|x| camera.turned(x));
        let low = places.clone().fold(Vec3::repeat(f64::INFINITY), |low, x| low.inf(&x));
        let high = places.fold(Vec3::repeat(f64::NEG_INFINITY), |high, x| high.sup(&x));
        if low.x > high.x {
            return camera;
        }
        let [width, height] = size.map(|pixels| pixels as f64 * (1.0 - 2.0 * MARGIN));
        let extent = (high - low).map(|extent| extent.max(1e-9));
        let middle = 0.5 * (low + high);
        camera.scale = (width / extent.x).min(height / extent.y);
        camera.middle = right * middle.x + up * middle.y + toward * middle.z;
        camera
    }

    fn turned(&self, x: &Vec3) -> Vec3 {
        Vec3::new(self.right.dot(x), self.up.dot(x), self.toward.dot(x))
    }
}

/// A picture that is being drawn.
#[derive(Clone, Debug)]
pub struct Image {
    width: usize,
    height: usize,
    /// Of each sample, by rows from the top.
    colors: Vec<Rgb>,
    depths: Vec<f64>,
}

/// A picture: its pixels by rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each.
    pub colors: Vec<Rgb>,
}

impl Image {
    /// A white picture of so many pixels.
    #[must_use]
    pub fn new([width, height]: [usize; 2]) -> Self {
        let samples = SAMPLES * SAMPLES * width * height;
        Self {
            width,
            height,
            colors: vec![[255; 3]; samples],
            depths: vec![f64::NEG_INFINITY; samples],
        }
    }

    /// Draws a `surface` in `color`.
    pub fn draw(&mut self, surface: &TriangleMesh, camera: &Camera, color: Rgb) {
        let mut normals = vec![Vec3::zeros(); surface.positions.len()];
        for triangle in &surface.triangles {
            let [a, b, c] = triangle.map(|v| surface.positions[v as usize]);
            let normal = (b - a).cross(&(c - a));
            triangle.iter().for_each(|&v| normals[v as usize] += normal);
        }
        // From above, over the eye's left shoulder.
        let light = (camera.toward - 0.5 * camera.right + 0.6 * camera.up).normalize();
        let shades: Vec<f64> = normals
            .iter()
            .map(|normal| {
                let normal = normal.try_normalize(0.0).unwrap_or(camera.toward);
                AMBIENT + (1.0 - AMBIENT) * normal.dot(&light).max(0.0)
            })
            .collect();
        let places: Vec<Vec3> = surface.positions.iter().map(|x| self.place(x, camera)).collect();
        for triangle in &surface.triangles {
            let corners = triangle.map(|v| places[v as usize]);
            let shades = triangle.map(|v| shades[v as usize]);
            self.fill(corners, shades, color);
        }
    }

    /// Draws the square of a plane about `point` (mm) that reaches `reach` (mm) to each side.
    pub fn draw_plane(
        &mut self,
        normal: Vec3,
        point: Vec3,
        reach: f64,
        camera: &Camera,
        color: Rgb,
    ) {
        let across = normal.cross(&Vec3::z()).try_normalize(1e-9).unwrap_or(Vec3::x());
        let along = normal.cross(&across);
        let corner = |s: f64, t: f64| point + across * (s * reach) + along * (t * reach);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let places = corners.map(|x| self.place(&x, camera));
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            self.fill([places[a], places[b], places[c]], [1.0; 3], color);
        }
    }

    /// In samples from the top left corner, and the depth.
    fn place(&self, x: &Vec3, camera: &Camera) -> Vec3 {
        let at = camera.turned(&(x - camera.middle)) * camera.scale;
        let half = |pixels: usize| 0.5 * pixels as f64;
        let samples = SAMPLES as f64;
        Vec3::new(samples * (half(self.width) + at.x), samples * (half(self.height) - at.y), at.z)
    }

    fn fill(&mut self, [a, b, c]: [Vec3; 3], shades: [f64; 3], color: Rgb) {
        let double_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        let is_drawn = double_area.abs() > 1e-12 && double_area.is_finite();
        if !is_drawn {
            return;
        }
        let [columns, rows] = [SAMPLES * self.width, SAMPLES * self.height];
        let range = |values: [f64; 3], count: usize| {
            let low = values.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0);
            let high = values.into_iter().fold(0.0, f64::max).ceil().min(count as f64);
            low as usize..high.max(0.0) as usize
        };
        for row in range([a.y, b.y, c.y], rows) {
            for column in range([a.x, b.x, c.x], columns) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let of = |p: &Vec3, q: &Vec3| {
                    ((p.x - x) * (q.y - y) - (q.x - x) * (p.y - y)) / double_area
                };
                let weights = [of(&b, &c), of(&c, &a), of(&a, &b)];
                if weights.iter().any(|weight| *weight < 0.0) {
                    continue;
                }
                let mean = |values: [f64; 3]| -> f64 {
                    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
                };
                let sample = row * columns + column;
                let depth = mean([a.z, b.z, c.z]);
                if depth > self.depths[sample] {
                    self.depths[sample] = depth;
                    let shade = mean(shades);
                    self.colors[sample] = color.map(|part| (shade * f64::from(part)) as u8);
                }
            }
        }
    }

    /// The picture as it is.
    #[must_use]
    pub fn pixels(&self) -> Pixels {
        let columns = SAMPLES * self.width;
        let mut colors = Vec::with_capacity(self.width * self.height);
        for row in 0..self.height {
            for column in 0..self.width {
                let mut sums = [0_u32; 3];
                for k in 0..SAMPLES * SAMPLES {
                    let (down, across) = (k / SAMPLES, k % SAMPLES);
                    let sample = (SAMPLES * row + down) * columns + SAMPLES * column + across;
                    for (sum, part) in sums.iter_mut().zip(self.colors[sample]) {
                        *sum += u32::from(part);
                    }
                }
                colors.push(sums.map(|sum| (sum / (SAMPLES * SAMPLES) as u32) as u8));
            }
        }
        Pixels { width: self.width, height: self.height, colors }
    }
}

impl Pixels {
    /// Pictures of one height side by side.
    ///
    /// # Panics
    /// When their heights differ.
    #[must_use]
    pub fn beside(pictures: &[Self]) -> Self {
        let height = pictures.first().map_or(0, |picture| picture.height);
        assert!(pictures.iter().all(|picture| picture.height == height), "one height");
        let row = |row: usize| {
            pictures.iter().flat_map(move |picture| {
                picture.colors[row * picture.width..(row + 1) * picture.width].iter().copied()
            })
        };
        let colors = (0..height).flat_map(row).collect();
        Self { width: pictures.iter().map(|picture| picture.width).sum(), height, colors }
    }

    /// Writes `text` with its left end, or its middle, at `x` and its base line at `y`, pixels from the top left corner.
    pub fn write(&mut self, text: &str, x: usize, y: usize, is_centred: bool) {
        let anchor = if is_centred { "middle" } else { "start" };
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\"><text x=\"{x}\" y=\"{y}\" \
             font-family=\"sans-serif\" font-size=\"13\" fill=\"#222831\" text-anchor=\"{anchor}\">{text}</text></svg>",
            self.width, self.height
        );
        let letters = canvas::pixmap(&svg, 1.0);
        for (color, letter) in self.colors.iter_mut().zip(letters.pixels()) {
            let ink = [letter.red(), letter.green(), letter.blue()];
            let rest = 255 - u32::from(letter.alpha());
            for (part, ink) in color.iter_mut().zip(ink) {
                *part = (u32::from(ink) + u32::from(*part) * rest / 255).min(255) as u8;
            }
        }
    }

    /// The picture as a PNG file.
    ///
    /// # Panics
    /// When it has no pixels.
    #[must_use]
    pub fn png(&self) -> Vec<u8> {
        let mut map = tiny_skia::Pixmap::new(self.width as u32, self.height as u32)
            .expect("a picture has pixels");
        for (pixel, [r, g, b]) in map.pixels_mut().iter_mut().zip(&self.colors) {
            *pixel = tiny_skia::PremultipliedColorU8::from_rgba(*r, *g, *b, 255)
                .expect("no part exceeds an opaque alpha");
        }
        map.encode_png().expect("a pixel map has a PNG form")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball fills the share `pi / 4` of the square about it, and the nearer of two hides the farther whatever their order.
    #[test]
    fn a_ball_is_a_disk_and_the_nearer_hides_the_farther() {
        let ball = TriangleMesh::sphere(10.0, 3);
        let size = [100, 100];
        let camera = Camera::beside(Vec3::x(), ball.positions.iter(), size);
        let drawn = |balls: &[(Vec3, Rgb)]| {
            let mut image = Image::new(size);
            for (offset, color) in balls {
                let positions = ball.positions.iter().map(|x| x + offset).collect();
                image.draw(&TriangleMesh { positions, ..ball.clone() }, &camera, *color);
            }
            image.pixels()
        };
        let one = drawn(&[(Vec3::zeros(), [200, 0, 0])]);
        let covered = one.colors.iter().filter(|color| **color != [255; 3]).count() as f64;
        let radius = 50.0 * (1.0 - 2.0 * MARGIN);
        let disk = std::f64::consts::PI * radius * radius;
        // Pixels at the rim, some 2 pi r of them, count whole: half of that too many, and the facets cut a little off.
        assert!((covered / disk - 1.0).abs() < 1.5 / radius, "{covered} {disk}");
        let behind = (-30.0 * camera.toward, [0, 200, 0]);
        let before = (Vec3::zeros(), [200, 0, 0]);
        assert_eq!(drawn(&[behind, before]), one);
        assert_eq!(drawn(&[before, behind]), one);
        // Brighter at the top left, from where the light comes.
        let red = |x: usize, y: usize| one.colors[100 * y + x][0];
        assert!(red(35, 30) > red(65, 70));
    }

    #[test]
    fn a_picture_has_its_letters_and_its_file() {
        let mut pixels = Image::new([80, 20]).pixels();
        pixels.write("43 deg", 40, 14, true);
        assert!(pixels.colors.iter().any(|color| color[0] < 100));
        let file = tiny_skia::Pixmap::decode_png(&pixels.png()).unwrap();
        assert_eq!((file.width(), file.height()), (80, 20));
        let both = Pixels::beside(&[pixels.clone(), pixels.clone()]);
        assert_eq!((both.width, both.colors[80]), (160, pixels.colors[0]));
        assert_eq!(both.colors[160..240], both.colors[240..320]);
    }
}
