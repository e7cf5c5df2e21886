//! The little-endian numbers of accessors.

use gltf::json::accessor::ComponentType;

/// The type of a number.
#[derive(Clone, Copy)]
pub(super) struct Number {
    component: ComponentType,
    /// Integers represent 0 to 1, or -1 to 1.
    normalized: bool,
}

impl Number {
    /// The type of a component of a position or normal: float32, or an integer of 8 or 16 bits (KHR_mesh_quantization).
    pub fn of_vector(component: ComponentType, normalized: bool) -> Option<Number> {
        let allowed = match component {
            ComponentType::U32 => false,
            ComponentType::F32 => !normalized,
            _ => true,
        };
        allowed.then_some(Number { component, normalized })
    }

    /// The type of a component of a color: float32, or an integer of 8 or 16 bits that represents 0 to 1.
    pub fn of_color(component: ComponentType, normalized: bool) -> Option<Number> {
        let allowed = match component {
            ComponentType::F32 => !normalized,
            ComponentType::U8 | ComponentType::U16 => normalized,
            _ => false,
        };
        allowed.then_some(Number { component, normalized })
    }

    /// The type of a vertex index.
    pub fn of_index(component: ComponentType) -> Option<Number> {
        let allowed = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        allowed.then_some(Number { component, normalized: false })
    }

    /// Size, bytes.
    pub fn size(self) -> usize {
        self.component.size()
    }

    /// The value of its bytes.
    pub fn real(self, bytes: &[u8]) -> f32 {
        let bits = Number::unsigned(bytes);
        let (value, largest) = match self.component {
            ComponentType::I8 => (f32::from(bits as u8 as i8), 127.0),
            ComponentType::U8 => (f32::from(bits as u8), 255.0),
            ComponentType::I16 => (f32::from(bits as u16 as i16), 32767.0),
            ComponentType::U16 => (f32::from(bits as u16), 65535.0),
            ComponentType::U32 | ComponentType::F32 => return f32::from_bits(bits),
        };
        // The smallest integer is a little below -1.
        if self.normalized { (value / largest).max(-1.0) } else { value }
    }

    /// The value of up to four bytes as an unsigned integer.
    pub fn unsigned(bytes: &[u8]) -> u32 {
        bytes.iter().rev().fold(0, |sum, b| sum << 8 | u32::from(*b))
    }
}
