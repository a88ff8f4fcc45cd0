//! Pictures as a film: a GIF that repeats, in colours of each picture's own.

use super::shaded::Pixels;

/// The film of `pictures` of one size as a GIF file, each shown so many hundredths of a second.
///
/// # Panics
/// When there is none, their sizes differ, or they are larger than the format holds (65,535 pixels a side).
#[must_use]
pub fn gif_film(pictures: &[(Pixels, u16)]) -> Vec<u8> {
    let (first, _) = pictures.first().expect("a film has pictures");
    let side =
        |pixels: usize| u16::try_from(pixels).expect("the format holds 65,535 pixels a side");
    let [width, height] = [first.width, first.height].map(side);
    let mut file = Vec::new();
    {
        let writing = "writing into memory cannot fail";
        let mut encoder = gif::Encoder::new(&mut file, width, height, &[]).expect(writing);
        encoder.set_repeat(gif::Repeat::Infinite).expect(writing);
        for (picture, delay) in pictures {
            assert_eq!([picture.width, picture.height], [first.width, first.height], "one size");
            let mut frame =
                gif::Frame::from_rgb_speed(width, height, picture.colors.as_flattened(), SPEED);
            frame.delay = *delay;
            encoder.write_frame(&frame).expect(writing);
        }
    }
    file
}

/// Of choosing colours, 1 to 30: at 10 shades do not show bands, and a picture takes 20 ms.
const SPEED: i32 = 10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_has_its_pictures_and_times() {
        let picture = |color| Pixels { width: 4, height: 2, colors: vec![color; 8] };
        let film = gif_film(&[(picture([255, 0, 0]), 6), (picture([0, 0, 255]), 80)]);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut read = options.read_info(&film[..]).unwrap();
        assert_eq!((read.width(), read.height(), read.repeat()), (4, 2, gif::Repeat::Infinite));
        for (color, delay) in [([255, 0, 0, 255], 6), ([0, 0, 255, 255], 80)] {
            let frame = read.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, delay);
            assert_eq!(frame.buffer[..4], color);
        }
        assert!(read.read_next_frame().unwrap().is_none());
    }
}
