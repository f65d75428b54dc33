%
{{ name }} ({{ title }})
{%- for comment in header %}
({{ comment }})
{%- endfor %}
{%- for line in lines %}
{%- match line %}
{%- when Line::Comment with (text) %}
({{ text }})
{%- when Line::Chord with (words) %}
{{ words }}
{%- when Line::Block with (n, words) %}
{{ n }}{{ words }}
{%- when Line::Cutting with (n) %}
{{ n }}G64
{%- when Line::Dwell with (n, seconds) %}
{{ n }}G04 P{{ seconds.milliseconds() }}
{%- when Line::Stop with (n, text) %}
{{ n }}M00 ({{ text }})
{%- when Line::Call with (n, program) %}
{{ n }}M98 P{{ program }}
{%- when Line::End with (n) %}
{{ n }}M30
{%- when Line::Subprogram with (program, text) %}
O{{ program }} ({{ text }})
{%- when Line::Return with (n) %}
{{ n }}M99
{%- endmatch %}
{%- endfor %}
%
