//! Accessors as random access to vectors of numbers (specification, section 3.6.2): strides, normalized integers,
//! sparse replacement, and zeros where there are no data.

use ajar_scene::{Diagnostic, Severity};
use gltf::json::{
    accessor::{ComponentType, Type},
    validation::Checked,
};
use rayon::prelude::*;

use super::{Asset, Context, at, buffers::View};

/// An accessor whose every element lies inside its data.
pub(super) struct Accessor<'a> {
    /// Number of elements, at least one.
    pub count: u32,
    /// Type of the components.
    pub kind: ComponentType,
    normalized: bool,
    /// Numbers of an element.
    pub width: usize,
    dense: Option<Elements<'a>>,
    /// Elements that are replaced, increasing, each with its place in what replaces them.
    sparse: Option<(Vec<(u32, u32)>, Elements<'a>)>,
}

/// Elements at equal distances.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Elements<'a> {
    /// `count` elements of `size` bytes from `offset` on.
    fn new(view: View<'a>, offset: u64, count: u64, size: usize, element: &str) -> Result<Self, Diagnostic> {
        let error = |message: String| Err(Diagnostic::error(message).element(element));
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            return error(format!("a stride of {stride} bytes is less than the element's {size}"));
        }
        let end =
            (count - 1).checked_mul(stride as u64).and_then(|last| last.checked_add(offset + size as u64));
        match (end, usize::try_from(offset).ok().and_then(|offset| view.bytes.get(offset..))) {
            (Some(end), Some(bytes)) if end <= view.bytes.len() as u64 => Ok(Self { bytes, stride }),
            _ => error(format!(
                "{count} elements of {size} bytes at distances of {stride} from {offset} on reach beyond the view of {} \
                 bytes",
                view.bytes.len()
            )),
        }
    }

    /// Component `component` of element `index` as `N` bytes; zeros outside, which [`Elements::new`] has excluded.
    fn component<const N: usize>(&self, index: usize, component: usize) -> [u8; N] {
        let start = index * self.stride + component * N;
        self.bytes.get(start..start + N).and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N])
    }

    /// Element `index` as `N` floats.
    fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        let start = index * self.stride;
        let bytes = self.bytes.get(start..start + 4 * N).unwrap_or_default();
        let (numbers, _) = bytes.as_chunks::<4>();
        std::array::from_fn(|i| numbers.get(i).copied().map_or(0.0, f32::from_le_bytes))
    }
}

impl<'a> Accessor<'a> {
    /// Checks the layout of `accessors[index]`, to which `user` refers and whose elements must have one of `widths`.
    ///
    /// # Errors
    /// The accessor contradicts itself or reaches beyond its data.
    pub fn open(
        asset: &'a Asset,
        context: &mut Context,
        index: usize,
        widths: &[usize],
        user: &str,
    ) -> Result<Self, Diagnostic> {
        let accessor = at(&asset.root.accessors, index, "accessors", user)?;
        let element = format!("accessors[{index}]");
        let error =
            |field: &str, message: String| Diagnostic::error(message).element(format!("{element}{field}"));
        let Checked::Valid(kind) = accessor.component_type else {
            return Err(error(".componentType", "unknown component type".into()));
        };
        let width = match accessor.type_ {
            // Others have columns of padded length.
            Checked::Valid(Type::Mat4) if kind.0 == ComponentType::F32 => 16,
            Checked::Valid(Type::Mat2 | Type::Mat3 | Type::Mat4) | Checked::Invalid => 0,
            Checked::Valid(vector) => vector.multiplicity(),
        };
        if !widths.contains(&width) {
            return Err(error(".type", format!("the type does not suit {user}")));
        }
        let count = u32::try_from(accessor.count.0).ok().filter(|&n| n > 0 && n < u32::MAX);
        let count =
            count.ok_or_else(|| error(".count", format!("a count of {} is impossible", accessor.count.0)))?;
        let size = width * kind.0.size();
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let dense = match accessor.buffer_view {
            Some(view) => {
                let view = asset.buffers.view(&asset.root, view.value(), &element)?;
                Some(Elements::new(view, bounded(offset, &element)?, u64::from(count), size, &element)?)
            }
            None => None,
        };
        let opened =
            Self { count, kind: kind.0, normalized: accessor.normalized, width, dense, sparse: None };
        let opened = opened.with_sparse(asset, context, index);
        context.opened.insert(index);
        opened
    }

    fn with_sparse(
        mut self,
        asset: &'a Asset,
        context: &mut Context,
        index: usize,
    ) -> Result<Self, Diagnostic> {
        let Some(sparse) = asset.root.accessors.get(index).and_then(|accessor| accessor.sparse.as_ref())
        else {
            return Ok(self);
        };
        let element = format!("accessors[{index}].sparse");
        let error =
            |field: &str, message: String| Diagnostic::error(message).element(format!("{element}{field}"));
        let count = sparse.count.0;
        if count == 0 || count > u64::from(self.count) {
            return Err(error(".count", format!("a count of {count} does not suit {} elements", self.count)));
        }
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(error(".indices.componentType", "unknown component type".into()));
        };
        let elements = |view: usize, offset: u64, size: usize, field: &str| {
            let element = format!("{element}{field}");
            let view = View { stride: None, ..asset.buffers.view(&asset.root, view, &element)? };
            Elements::new(view, bounded(offset, &element)?, count, size, &element)
        };
        let indices = &sparse.indices;
        let from = elements(indices.buffer_view.value(), indices.byte_offset.0, kind.0.size(), ".indices")?;
        let values = &sparse.values;
        let size = self.width * self.kind.size();
        let values = elements(values.buffer_view.value(), values.byte_offset.0, size, ".values")?;
        context.charge(count * 8, &element)?;
        let mut replaced: Vec<_> =
            (0..count as u32).map(|slot| (whole(&from, kind.0, slot as usize), slot)).collect();
        if !replaced.is_sorted_by(|a, b| a.0 < b.0) {
            if !context.opened.contains(&index) {
                let message = "the indices do not increase; the last of equal ones counts";
                context.report.warn(format!("{element}.indices"), message);
            }
            replaced.sort_by_key(|&(index, slot)| (index, std::cmp::Reverse(slot)));
            replaced.dedup_by_key(|&mut (index, _)| index);
        }
        if let Some((last, _)) = replaced.last().filter(|(last, _)| *last >= self.count) {
            let message = format!("points to element {last}, but there are only {}", self.count);
            return Err(error(".indices", message));
        }
        self.sparse = Some((replaced, values));
        Ok(self)
    }

    /// Whether nothing gives the elements a value, so that all are zero.
    pub fn is_all_zeros(&self) -> bool {
        self.dense.is_none() && self.sparse.is_none()
    }

    /// Element `index` as real numbers; components beyond its width have the value of `missing`.
    pub fn get<const N: usize>(&self, index: u32, missing: f32) -> [f32; N] {
        let Some((elements, index)) = self.locate(index) else { return [0.0; N] };
        std::array::from_fn(|i| if i < self.width { self.real(elements, index, i) } else { missing })
    }

    /// The elements at these indices as [`get`](Self::get) gives them, on all cores.
    pub fn gather<const N: usize, T>(&self, indices: &[u32], missing: f32) -> Vec<T>
    where
        T: From<[f32; N]> + Send,
    {
        let indices = indices.par_iter();
        match (&self.dense, &self.sparse) {
            // What large files consist of.
            (Some(dense), None) if self.kind == ComponentType::F32 && self.width == N => {
                indices.map(|&i| T::from(dense.floats(i as usize))).collect()
            }
            _ => indices.map(|&i| T::from(self.get(i, missing))).collect(),
        }
    }

    /// All elements of an accessor of unsigned scalars.
    pub fn indices(&self) -> Vec<u32> {
        let index = |i| self.locate(i).map_or(0, |(elements, i)| whole(elements, self.kind, i));
        (0..self.count).into_par_iter().map(index).collect()
    }

    /// Where the element is stored, if it is.
    fn locate(&self, index: u32) -> Option<(&Elements<'a>, usize)> {
        if let Some((indices, values)) = &self.sparse
            && let Ok(at) = indices.binary_search_by_key(&index, |&(index, _)| index)
        {
            return indices.get(at).map(|&(_, slot)| (values, slot as usize));
        }
        self.dense.as_ref().map(|elements| (elements, index as usize))
    }

    fn real(&self, elements: &Elements, index: usize, component: usize) -> f32 {
        let (value, one) = match self.kind {
            ComponentType::F32 => return f32::from_le_bytes(elements.component(index, component)),
            ComponentType::U32 => return u32::from_le_bytes(elements.component(index, component)) as f32,
            ComponentType::I8 => (f32::from(i8::from_le_bytes(elements.component(index, component))), 127.0),
            ComponentType::U8 => (f32::from(u8::from_le_bytes(elements.component(index, component))), 255.0),
            ComponentType::I16 => {
                (f32::from(i16::from_le_bytes(elements.component(index, component))), 32767.0)
            }
            ComponentType::U16 => {
                (f32::from(u16::from_le_bytes(elements.component(index, component))), 65535.0)
            }
        };
        if self.normalized { (value / one).max(-1.0) } else { value }
    }
}

/// An unsigned scalar.
fn whole(elements: &Elements, kind: ComponentType, index: usize) -> u32 {
    match kind {
        ComponentType::U8 => u32::from(u8::from_le_bytes(elements.component(index, 0))),
        ComponentType::U16 => u32::from(u16::from_le_bytes(elements.component(index, 0))),
        _ => u32::from_le_bytes(elements.component(index, 0)),
    }
}

/// The offset, if sums with it cannot overflow.
fn bounded(offset: u64, element: &str) -> Result<u64, Diagnostic> {
    let error = || Diagnostic::error(format!("an offset of {offset} bytes is impossible")).element(element);
    u32::try_from(offset >> 16).map(|_| offset).map_err(|_| error())
}

/// Warns about accessors with an impossible layout that nothing which is read asked for: the others are errors by now.
pub(super) fn check_unused(asset: &Asset, context: &mut Context) {
    for index in 0..asset.root.accessors.len() {
        let matrix = matches!(
            asset.root.accessors.get(index).map(|accessor| accessor.type_),
            Some(Checked::Valid(Type::Mat2 | Type::Mat3 | Type::Mat4))
        );
        if matrix || context.opened.contains(&index) {
            continue;
        }
        if let Err(error) = Accessor::open(asset, context, index, &[1, 2, 3, 4], "anything") {
            context.report.add(Diagnostic { severity: Severity::Warning, ..error });
        }
    }
}

/// Where the first value is that is wrong, if any, on all cores.
pub(super) fn first<T: Sync>(values: &[T], is_wrong: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    // Looked at by the chunk, without an exit in it, so that many values are looked at with one instruction.
    const CHUNK: usize = 4096;
    let has_wrong = |chunk: &[T]| chunk.iter().fold(false, |found, value| found | is_wrong(value));
    let chunk = values.par_chunks(CHUNK).position_first(has_wrong)?;
    let start = chunk * CHUNK;
    values.get(start..)?.iter().position(is_wrong).map(|at| start + at)
}
