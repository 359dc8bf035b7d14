//! What a stage says of a pass that it adds.

use super::Pass;

impl Pass {
    /// Sets a specialization constant.
    pub fn constant(&mut self, name: &'static str, value: u32) -> &mut Self {
        self.constants.push((name, value));
        self
    }

    /// Binds another resource to one of the shader's names.
    pub fn bind(&mut self, shader_name: &'static str, resource: impl Into<String>) -> &mut Self {
        self.aliases.insert(shader_name, resource.into());
        self
    }

    /// Binds a placeholder: the shader, as specialised, does not read it.
    pub fn absent(&mut self, shader_name: &'static str) -> &mut Self {
        self.bind(shader_name, "")
    }

    /// Sets the push constants.
    pub fn push<T: bytemuck::NoUninit>(&mut self, value: &T) -> &mut Self {
        self.push = bytemuck::bytes_of(value).to_vec();
        self
    }
}
