//! The whole synchronization story: what an access is, and the barrier between two of them.
//!
//! A resource access is one name, [`Usage`] = (stage, access, layout). [`State`] remembers how a resource was last used;
//! [`State::next`] says which barrier, if any, the next use needs. Nothing else in the project places a barrier.

use ash::vk;
use vk::{AccessFlags2 as A, ImageLayout as L, PipelineStageFlags2 as S};

/// One way to use a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Usage {
    /// Read as a storage image or buffer by compute.
    ComputeRead,
    /// Written as a storage image or buffer by compute, no earlier content needed.
    ComputeWrite,
    /// Read and written (atomics, appends) by compute.
    ComputeReadWrite,
    /// Sampled by compute.
    ComputeSampled,
    /// Sampled by fragment shaders.
    FragmentSampled,
    /// Uniform buffer of compute.
    ComputeUniform,
    /// Uniform buffer of vertex and fragment shaders.
    GraphicsUniform,
    /// Storage buffer read by vertex and fragment shaders.
    GraphicsRead,
    /// Colour attachment, cleared or fully written.
    ColorAttachment,
    /// Depth attachment, cleared, tested and written.
    DepthAttachment,
    /// Colour attachment, drawn over what is there.
    ColorOver,
    /// Depth attachment, tested alone.
    DepthTest,
    /// Arguments of an indirect dispatch.
    Indirect,
    /// Source of a copy.
    CopyFrom,
    /// Destination of a copy, fill or update.
    CopyTo,
    /// Read by the host after the frame's fence.
    Host,
}

/// What a usage means to Vulkan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Pipeline stages that access.
    pub stage: S,
    /// Kinds of access.
    pub access: A,
    /// Image layout; ignored for buffers.
    pub layout: L,
    /// The access writes.
    pub writes: bool,
    /// The access does not need what was there before.
    pub discards: bool,
}

impl Usage {
    /// The table.
    pub fn access(self) -> Access {
        let depth_stages = S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS;
        let depth_access = A::DEPTH_STENCIL_ATTACHMENT_READ | A::DEPTH_STENCIL_ATTACHMENT_WRITE;
        let graphics = S::VERTEX_SHADER | S::FRAGMENT_SHADER;
        #[rustfmt::skip]
        let (stage, access, layout, writes, discards) = match self {
            Usage::ComputeRead      => (S::COMPUTE_SHADER, A::SHADER_STORAGE_READ, L::GENERAL, false, false),
            Usage::ComputeWrite     => (S::COMPUTE_SHADER, A::SHADER_STORAGE_WRITE, L::GENERAL, true, true),
            Usage::ComputeReadWrite => (S::COMPUTE_SHADER, A::SHADER_STORAGE_READ | A::SHADER_STORAGE_WRITE, L::GENERAL, true, false),
            Usage::ComputeSampled   => (S::COMPUTE_SHADER, A::SHADER_SAMPLED_READ, L::SHADER_READ_ONLY_OPTIMAL, false, false),
            Usage::FragmentSampled  => (S::FRAGMENT_SHADER, A::SHADER_SAMPLED_READ, L::SHADER_READ_ONLY_OPTIMAL, false, false),
            Usage::ComputeUniform   => (S::COMPUTE_SHADER, A::UNIFORM_READ, L::UNDEFINED, false, false),
            Usage::GraphicsUniform  => (graphics, A::UNIFORM_READ, L::UNDEFINED, false, false),
            Usage::GraphicsRead     => (graphics, A::SHADER_STORAGE_READ, L::GENERAL, false, false),
            Usage::ColorAttachment  => (S::COLOR_ATTACHMENT_OUTPUT, A::COLOR_ATTACHMENT_WRITE, L::COLOR_ATTACHMENT_OPTIMAL, true, true),
            Usage::DepthAttachment  => (depth_stages, depth_access, L::DEPTH_ATTACHMENT_OPTIMAL, true, true),
            Usage::ColorOver        => (S::COLOR_ATTACHMENT_OUTPUT, A::COLOR_ATTACHMENT_READ | A::COLOR_ATTACHMENT_WRITE, L::COLOR_ATTACHMENT_OPTIMAL, true, false),
            Usage::DepthTest        => (depth_stages, A::DEPTH_STENCIL_ATTACHMENT_READ, L::DEPTH_ATTACHMENT_OPTIMAL, false, false),
            Usage::Indirect         => (S::DRAW_INDIRECT, A::INDIRECT_COMMAND_READ, L::UNDEFINED, false, false),
            Usage::CopyFrom         => (S::ALL_TRANSFER, A::TRANSFER_READ, L::TRANSFER_SRC_OPTIMAL, false, false),
            Usage::CopyTo           => (S::ALL_TRANSFER, A::TRANSFER_WRITE, L::TRANSFER_DST_OPTIMAL, true, true),
            Usage::Host             => (S::HOST, A::HOST_READ, L::GENERAL, false, false),
        };
        Access { stage, access, layout, writes, discards }
    }
}

/// One side of a barrier decided from two usages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Barrier {
    /// Stages waited for.
    pub src_stage: S,
    /// Writes made available; empty where only execution is ordered.
    pub src_access: A,
    /// Stages that wait.
    pub dst_stage: S,
    /// Accesses made visible to.
    pub dst_access: A,
    /// Layout before; UNDEFINED discards.
    pub old_layout: L,
    /// Layout after.
    pub new_layout: L,
}

/// How a resource was last used: the last write, and the reads since.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    layout: L,
    write_stage: S,
    write_access: A,
    read_stage: S,
    read_access: A,
}

impl State {
    /// Nothing has touched it yet.
    pub const NEW: State = State {
        layout: L::UNDEFINED,
        write_stage: S::NONE,
        write_access: A::NONE,
        read_stage: S::NONE,
        read_access: A::NONE,
    };

    /// The layout it is in.
    pub fn layout(&self) -> L {
        self.layout
    }

    /// The same history with its content forgotten: the resource (or its memory) starts a new life, but whoever writes it
    /// first must still wait for those who used it before.
    pub fn reborn(&self) -> State {
        State { layout: L::UNDEFINED, ..*self }
    }

    /// Two resources that share memory: whoever comes next waits for both.
    pub fn and(&self, other: &State) -> State {
        State {
            layout: L::UNDEFINED,
            write_stage: self.write_stage | other.write_stage,
            write_access: self.write_access | other.write_access,
            read_stage: self.read_stage | other.read_stage,
            read_access: self.read_access | other.read_access,
        }
    }

    /// Moves to `usage` and returns the barrier that this needs. A read after a read of the same layout, whose stage has
    /// already been made to see the last write, needs none. `image` tells whether layouts matter.
    pub fn next(&mut self, usage: Usage, image: bool) -> Option<Barrier> {
        let to = usage.access();
        let layout = if image { to.layout } else { L::UNDEFINED };
        let same_layout = !image || self.layout == layout;
        if !to.writes && same_layout {
            let seen = self.read_stage.contains(to.stage) && self.read_access.contains(to.access);
            let untouched = self.write_stage.is_empty();
            let barrier = (!seen && !untouched).then_some(Barrier {
                src_stage: self.write_stage,
                src_access: self.write_access,
                dst_stage: to.stage,
                dst_access: to.access,
                old_layout: layout,
                new_layout: layout,
            });
            self.read_stage |= to.stage;
            self.read_access |= to.access;
            return barrier;
        }
        // A write, or a change of layout (which writes too): wait for the readers; where there were none, for the writer.
        let (src_stage, src_access) =
            if self.read_stage.is_empty() || !self.write_stage.is_empty() && self.layout == L::UNDEFINED {
                (self.write_stage | self.read_stage, self.write_access)
            } else {
                (self.read_stage, A::NONE)
            };
        // What was written before in this frame is kept even by a use that writes: it may write a part. Content is only
        // forgotten where a life begins ([`State::reborn`]).
        let old_layout = self.layout;
        let transition = image && !(same_layout && self.layout != L::UNDEFINED);
        let barrier = (transition || !src_stage.is_empty()).then_some(Barrier {
            src_stage,
            src_access,
            dst_stage: to.stage,
            dst_access: to.access,
            old_layout: if transition { old_layout } else { layout },
            new_layout: layout,
        });
        *self = if to.writes {
            State {
                layout,
                write_stage: to.stage,
                write_access: to.access & WRITES,
                read_stage: S::NONE,
                read_access: A::NONE,
            }
        } else {
            // The transition is the write that later readers of other stages must see; it was made visible to this one.
            State { layout, write_stage: to.stage, write_access: A::NONE, read_stage: to.stage, read_access: to.access }
        };
        barrier
    }
}

/// The accesses that write: only these need to be made available.
const WRITES: A = A::from_raw(
    A::SHADER_STORAGE_WRITE.as_raw()
        | A::COLOR_ATTACHMENT_WRITE.as_raw()
        | A::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
        | A::TRANSFER_WRITE.as_raw(),
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_after_read_is_free() {
        let mut s = State::NEW;
        assert!(s.next(Usage::ComputeWrite, true).is_some(), "the first use leaves UNDEFINED");
        let first = s.next(Usage::ComputeRead, true).expect("read after write");
        assert_eq!(first.src_access, A::SHADER_STORAGE_WRITE);
        assert_eq!(s.next(Usage::ComputeRead, true), None);
    }

    #[test]
    fn a_reader_of_another_stage_still_waits_for_the_writer() {
        let mut s = State::NEW;
        s.next(Usage::ComputeWrite, false);
        s.next(Usage::ComputeRead, false);
        let b = s.next(Usage::Indirect, false).expect("the indirect stage has not seen the write yet");
        assert_eq!((b.src_stage, b.dst_stage), (S::COMPUTE_SHADER, S::DRAW_INDIRECT));
    }

    #[test]
    fn write_after_read_orders_execution_only() {
        let mut s = State::NEW;
        s.next(Usage::ComputeWrite, true);
        s.next(Usage::ComputeRead, true);
        let b = s.next(Usage::ComputeWrite, true).expect("write after read");
        assert_eq!((b.src_stage, b.src_access), (S::COMPUTE_SHADER, A::NONE));
        assert_eq!(b.old_layout, b.new_layout, "no transition where the layout stays");
    }

    #[test]
    fn a_partial_write_keeps_what_a_clear_wrote() {
        let mut s = State::NEW;
        s.next(Usage::CopyTo, true);
        let b = s.next(Usage::ComputeWrite, true).expect("another layout");
        assert_eq!(b.old_layout, L::TRANSFER_DST_OPTIMAL, "UNDEFINED would lose the background");
        let b = s.reborn().next(Usage::CopyTo, true).expect("the next frame");
        assert_eq!(b.old_layout, L::UNDEFINED, "the twin: a new life forgets");
    }

    #[test]
    fn shared_memory_waits_for_its_last_tenant() {
        let mut tenant = State::NEW;
        tenant.next(Usage::ColorAttachment, true);
        let mut next = State::NEW.and(&tenant);
        let b = next.next(Usage::ComputeWrite, true).expect("the memory was someone else's");
        assert!(b.src_stage.contains(S::COLOR_ATTACHMENT_OUTPUT) && b.old_layout == L::UNDEFINED);
        assert!(b.src_access.contains(A::COLOR_ATTACHMENT_WRITE));
    }
}
