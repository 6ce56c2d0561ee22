; The scopes of names, and where names are defined.

(scene) @local.scope
(function) @local.scope
(section) @local.scope
(block) @local.scope
(body) @local.scope
(for) @local.scope
(loop) @local.scope

(param name: (name) @local.definition.var)
(let name: (name) @local.definition.var)
(parameter name: (name) @local.definition.parameter)
(for variable: (name) @local.definition.var)
(loop variable: (name) @local.definition.var)
(function name: (name) @local.definition.function)

(name) @local.reference
